// Frames of a sliding window that were made for a measurement between images.

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "gnss/model/gnss_epoch.h"
#include "smoother/sliding/smoother_estimator.h"
#include "tests/gnss/model/synthetic_sky.h"
#include "tests/support/fix_scenario.h"

namespace alidade::test {
namespace {

/// A slow figure-8 with fixes between the frames.
Dataset SlowWalkWithFixes() {
  SimulatorConfig scene;
  scene.duration_s = 6;
  scene.path_m = 8;
  scene.max_features = 60;
  scene.fix.rate_hz = 2;
  scene.fix.std_m = 0.2;
  scene.fix.time_offset_s = 0.033;
  return SimulateOrDie(scene, 3);
}

/// Every fix has a frame of its own, and every frame is a keyframe.
EstimatorConfig FramesForFixes() {
  EstimatorConfig config;
  config.backend = Backend::kSmoother;
  config.smoother.frames = FramePolicy::kEveryFrame;
  config.fix.max_interpolation_s = 0;
  return config;
}

const TrackFrame& LastFrameBefore(const Dataset& dataset, TimeNs stamp_ns) {
  const auto later = std::find_if(dataset.frames.begin(), dataset.frames.end(),
                                  [&](const TrackFrame& frame) { return frame.stamp_ns >= stamp_ns; });
  EXPECT_NE(later, dataset.frames.begin());
  return *(later - 1);
}

// GIVEN a frame that was made for a fix THEN the tracks of the last image are still in sight: nothing has
// said that they are lost.
TEST(MeasurementFrame, TracksStayAliveOverIt) {
  const Dataset dataset = SlowWalkWithFixes();
  SmootherEstimator smoother(FramesForFixes(), dataset.rig);
  int fixes = 0;
  RunWithFixes(dataset, DrawInitialState(dataset, 3), &smoother, [&](const PositionFix& fix) {
    const Window& window = smoother.window();
    ASSERT_EQ(window.newest().stamp_ns, fix.stamp_ns) << "a frame of its own";
    const TrackFrame& image = LastFrameBefore(dataset, fix.stamp_ns);
    ASSERT_GT(image.observations.size(), 20u);
    for (const TrackObservation& seen : image.observations) {
      const auto track = window.tracks().find(seen.track_id);
      ASSERT_NE(track, window.tracks().end()) << seen.track_id;
      EXPECT_TRUE(track->second.alive) << seen.track_id;
    }
    ++fixes;
  });
  EXPECT_GE(fixes, 10);
}

// GIVEN landmarks that are all nearer than any landmark may be, WHEN a frame leaves the window and its tracks
// are looked at for that too, THEN no track is counted twice in the frame that comes.
TEST(MeasurementFrame, ATrackIsCountedAsDegenerateOnce) {
  const Dataset dataset = SlowWalkWithFixes();
  EstimatorConfig config = FramesForFixes();
  config.vision.min_depth_m = 200;
  SmootherEstimator smoother(config, dataset.rig);
  int degenerate = 0;
  int leaving = 0;
  RunWithFixes(dataset, DrawInitialState(dataset, 3), &smoother, [&](const PositionFix&) {
    const Window& window = smoother.window();
    const FrameStatistics& statistics = smoother.last_statistics();
    int tracks = 0;
    for (const auto& [id, track] : window.tracks()) {
      EXPECT_FALSE(track.has_landmark) << id;
      tracks += track.views.size() != 1 ? 1 : 0;  // no view: the gate has just refused the track
      leaving += !track.views.empty() && track.views.front().frame->index == 0 ? 1 : 0;
    }
    EXPECT_LE(statistics.features_waiting + statistics.features_degenerate, tracks);
    degenerate += statistics.features_degenerate;
  });
  EXPECT_GT(degenerate, 100);
  EXPECT_GT(leaving, 100) << "tracks that the next frame looks at twice";
}

/// An epoch of a receiver at rest whose clock stands at `clock_m`.
GnssEpoch EpochAtRest(const EstimatorConfig& config, SyntheticReceiver receiver, TimeNs stamp_ns,
                      double clock_m) {
  const NavigationData sky = SyntheticSky(receiver.stamp_ns);
  receiver.stamp_ns = stamp_ns;
  receiver.clock_m = clock_m;
  GnssEpoch epoch;
  epoch.stamp_ns = stamp_ns;
  epoch.builder = std::make_shared<const MeasurementBuilder>(std::make_shared<SatelliteCatalog>(sky),
                                                             config.gnss.corrections);
  epoch.measurements = epoch.builder->Prepare(Observe(sky, receiver));
  return epoch;
}

// GIVEN an epoch that corrected the estimate, WHEN the receiver's clock steps so that the next one is left
// out, THEN that one has no correction: it would be compared with a position that it did not cause.
TEST(MeasurementFrame, AnEpochThatIsLeftOutHasNoCorrection) {
  SyntheticReceiver receiver;
  receiver.stamp_ns = 1'700'000'100 * kSecondNs;
  EstimatorConfig config;
  config.backend = Backend::kSmoother;
  config.gnss.enabled = true;
  config.gnss.corrections.ionosphere = IonosphereMode::kNone;
  config.calibration.watch = true;
  SimulatorConfig scene;
  scene.duration_s = 1;
  scene.path_m = 1;
  SmootherEstimator smoother(config, SimulateOrDie(scene, 1).rig);
  NavEstimate start;
  start.stamp_ns = receiver.stamp_ns;
  start.covariance = Matrix15d::Identity();
  ASSERT_TRUE(smoother.Initialize(start).ok());
  GnssAlignment alignment = IdentityAlignment(start.stamp_ns);
  alignment.enu = EnuFrame::At(receiver.position_E);
  alignment.clock = Vector6d::Zero();
  ASSERT_TRUE(smoother.Align(alignment).ok());
  for (int i = 0; i <= 30; ++i) {
    ASSERT_TRUE(
        smoother.AddImu({start.stamp_ns + i * 10'000'000LL, Eigen::Vector3d::Zero(), {0, 0, 9.81}}).ok());
  }
  ASSERT_TRUE(smoother.AddFrame({start.stamp_ns, {}}).ok());

  const TimeNs first_ns = start.stamp_ns + SecondsToNs(0.1);
  const Status first = smoother.AddGnss(EpochAtRest(config, receiver, first_ns, 0));
  ASSERT_TRUE(first.ok()) << first.message();
  EXPECT_FALSE(smoother.last_statistics().clock_jump);
  ASSERT_NE(smoother.last_correction(), nullptr);

  const TimeNs next_ns = start.stamp_ns + SecondsToNs(0.2);
  const Status next = smoother.AddGnss(EpochAtRest(config, receiver, next_ns, 1000));
  ASSERT_TRUE(next.ok()) << next.message();
  ASSERT_TRUE(smoother.last_statistics().clock_jump);
  EXPECT_EQ(smoother.last_correction(), nullptr);
}

// GIVEN a fix that corrected the estimate, WHEN the estimator starts anew, THEN nothing has been corrected.
TEST(MeasurementFrame, AStartAnewHasNoCorrection) {
  const Dataset dataset = SlowWalkWithFixes();
  EstimatorConfig config = FramesForFixes();
  config.calibration.watch = true;
  SmootherEstimator smoother(config, dataset.rig);
  const NavEstimate start = DrawInitialState(dataset, 3);
  RunWithFixes(dataset, start, &smoother, [](const PositionFix&) {});
  ASSERT_NE(smoother.last_correction(), nullptr);
  ASSERT_TRUE(smoother.Initialize(start).ok());
  EXPECT_EQ(smoother.last_correction(), nullptr);
}

}  // namespace
}  // namespace alidade::test
