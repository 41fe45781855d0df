// Frames of a sliding window that were made for a measurement between images.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

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

/// Of frames that leave the window as soon as they may, whatever the tracks: none has parallax enough.
EstimatorConfig FewKeyframes() {
  EstimatorConfig config;
  config.backend = Backend::kSmoother;
  config.smoother.keyframe_parallax_px = 500;
  config.smoother.keyframe_min_tracked = 0;
  config.vision.rest_updates = false;
  return config;
}

double LongestInterval(const Window& window) {
  double longest_s = 0;
  for (int i = 1; i < window.size(); ++i) {
    longest_s = std::max(longest_s, SecondsBetween(window.frame(i - 1).stamp_ns, window.frame(i).stamp_ns));
  }
  return longest_s;
}

/// Runs over the fixes of `dataset`: frames leave the window, but none that holds a fix where the frame
/// before it is further than max_interpolation_s away.
void ExpectFixesNearTheirFrames(const Dataset& dataset, const EstimatorConfig& config) {
  SmootherEstimator smoother(config, dataset.rig);
  int attached = 0;
  double longest_s = 0;
  RunWithFixes(dataset, DrawInitialState(dataset, 3), &smoother, [&](const PositionFix&) {
    const Window& window = smoother.window();
    longest_s = std::max(longest_s, LongestInterval(window));
    for (int i = 0; i < window.size(); ++i) {
      for (const FrameMeasurement& fix : window.frame(i).measurements) {
        ASSERT_FALSE(fix.imu.empty());
        EXPECT_LE(SecondsBetween(window.frame(i).stamp_ns, fix.imu.back().stamp_ns),
                  config.fix.max_interpolation_s);
        ++attached;
      }
    }
  });
  EXPECT_GT(attached, 20);
  EXPECT_GT(longest_s, 0.25) << "frames have left";
}

// GIVEN fixes between frames that are no keyframes, WHEN these leave the window, THEN no fix is attached to a
// frame further away than max_interpolation_s.
TEST(MeasurementFrame, AFixStaysNearTheFrameItIsAttachedTo) {
  ExpectFixesNearTheirFrames(SlowWalkWithFixes(), FewKeyframes());
}

// GIVEN fixes between frames of an image that is repeated, THEN likewise.
TEST(MeasurementFrame, AFixStaysNearTheFrameOfARepeatedImage) {
  Dataset dataset = SlowWalkWithFixes();
  for (size_t i = 10; i < dataset.frames.size(); ++i) {
    dataset.frames[i].observations.clear();
    dataset.frames[i].repeated = true;
  }
  EstimatorConfig config = FewKeyframes();
  config.smoother.frames = FramePolicy::kEveryFrame;
  ExpectFixesNearTheirFrames(dataset, config);
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

/// A rig at rest with a receiver whose sky is synthetic, aligned, and the IMU of the seconds that come.
struct RestingReceiver {
  explicit RestingReceiver(EstimatorConfig config_in) : config(std::move(config_in)) {
    receiver.stamp_ns = 1'700'000'100 * kSecondNs;
    config.backend = Backend::kSmoother;
    config.gnss.enabled = true;
    config.gnss.corrections.ionosphere = IonosphereMode::kNone;
    SimulatorConfig scene;
    scene.duration_s = 1;
    scene.path_m = 1;
    smoother = std::make_unique<SmootherEstimator>(config, SimulateOrDie(scene, 1).rig);
  }

  [[nodiscard]] TimeNs StampAt(double seconds) const { return receiver.stamp_ns + SecondsToNs(seconds); }
  void Begin(double imu_s) {
    NavEstimate start;
    start.stamp_ns = receiver.stamp_ns;
    start.covariance = Matrix15d::Identity();
    ASSERT_TRUE(smoother->Initialize(start).ok());
    GnssAlignment alignment = IdentityAlignment(start.stamp_ns);
    alignment.enu = EnuFrame::At(receiver.position_E);
    alignment.clock = Vector6d::Zero();
    ASSERT_TRUE(smoother->Align(alignment).ok());
    for (int i = 0; i <= static_cast<int>(std::lround(100 * imu_s)); ++i) {
      ASSERT_TRUE(
          smoother->AddImu({start.stamp_ns + i * 10'000'000LL, Eigen::Vector3d::Zero(), {0, 0, 9.81}}).ok());
    }
  }
  void AddEpoch(double seconds, double clock_m) const {
    const Status status = smoother->AddGnss(EpochAtRest(config, receiver, StampAt(seconds), clock_m));
    ASSERT_TRUE(status.ok()) << status.message();
  }

  SyntheticReceiver receiver;
  EstimatorConfig config;
  std::unique_ptr<SmootherEstimator> smoother;
};

// GIVEN an epoch that corrected the estimate, WHEN the receiver's clock steps so that the next one is left
// out, THEN that one has no correction: it would be compared with a position that it did not cause.
TEST(MeasurementFrame, AnEpochThatIsLeftOutHasNoCorrection) {
  EstimatorConfig config;
  config.calibration.watch = true;
  RestingReceiver rig(config);
  rig.Begin(0.3);
  ASSERT_TRUE(rig.smoother->AddFrame({rig.StampAt(0), {}}).ok());
  rig.AddEpoch(0.1, 0);
  EXPECT_FALSE(rig.smoother->last_statistics().clock_jump);
  ASSERT_NE(rig.smoother->last_correction(), nullptr);
  rig.AddEpoch(0.2, 1000);
  ASSERT_TRUE(rig.smoother->last_statistics().clock_jump);
  EXPECT_EQ(rig.smoother->last_correction(), nullptr);
}

// GIVEN epochs after frames that are no keyframes, THEN likewise.
TEST(MeasurementFrame, AnEpochStaysNearTheFrameItIsAttachedTo) {
  RestingReceiver rig(FewKeyframes());
  rig.Begin(3.2);
  const Window& window = rig.smoother->window();
  int attached = 0;
  double longest_s = 0;
  for (int k = 0; k <= 30; ++k) {
    TrackFrame frame{rig.StampAt(0.1 * k), {}};
    for (int i = 0; i < 30; ++i) {
      const int row = i / 6;
      frame.observations.push_back({i, {100.0 + 50 * (i % 6), 100.0 + 40 * row}});
    }
    const Status status = rig.smoother->AddFrame(frame);
    ASSERT_TRUE(status.ok()) << status.message();
    if (k % 5 == 1) {
      rig.AddEpoch(0.1 * k + 0.05, 0);
    }
    longest_s = std::max(longest_s, LongestInterval(window));
    for (int i = 0; i < window.size(); ++i) {
      for (const FrameEpoch& epoch : window.frame(i).epochs) {
        EXPECT_LE(epoch.SecondsAfter(window.frame(i).stamp_ns), rig.config.gnss.max_interpolation_s);
        ++attached;
      }
    }
  }
  EXPECT_GT(attached, 20);
  EXPECT_GT(longest_s, 0.25) << "frames have left";
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
