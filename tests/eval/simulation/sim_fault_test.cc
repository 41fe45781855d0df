#include "eval/simulation/sim_fault.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "eval/simulation/simulator.h"
#include "tests/eval/simulation/sim_scene.h"

namespace alidade {
namespace {

using test::MinuteConfig;
using test::SimScene;

constexpr std::uint64_t kSeed = 3;

SimulatorConfig WithOutlierTracks(SimOutlierKind kind, double rate) {
  SimulatorConfig config = MinuteConfig();
  config.outlier_kind = kind;
  config.outlier_unit = SimOutlierUnit::kTrack;
  config.outlier_rate = rate;
  return config;
}

/// The fault that a track was dealt at its birth.
TrackFault FaultOf(const SimScene& scene, std::int64_t track, int first_frame) {
  return FaultSource(scene.config, kSeed, "camera").OfTrack(scene.LandmarkOf(track), first_frame);
}

/// Of the tracks of at least six frames (so that every onset has passed), the share that went wrong must be
/// the rate, to four deviations of a binomial.
void ExpectRateOfLongTracks(const SimScene& scene) {
  double wrong = 0, count = 0;
  for (const auto& [track, observations] : scene.ByTrack()) {
    if (observations.size() >= 6) {
      wrong += scene.IsOutlier(track) ? 1 : 0;
      count += 1;
    }
  }
  const double rate = scene.config.outlier_rate;
  ASSERT_GT(count, 1000);
  EXPECT_NEAR(wrong / count, rate, 4 * std::sqrt(rate * (1 - rate) / count));
}

TEST(SimFaultTest, ATrackThatJumpsIsRightAndThenOffByOneVector) {
  const SimScene scene(WithOutlierTracks(SimOutlierKind::kJump, 0.2), kSeed);
  int jumped = 0;
  for (const auto& [track, observations] : scene.ByTrack()) {
    const int first = observations.front().first;
    const TrackFault fault = FaultOf(scene, track, first);
    EXPECT_TRUE(fault.wrong || !scene.IsOutlier(track));
    for (const auto& [frame, pixel] : observations) {
      const bool wrong = fault.wrong && frame - first >= fault.onset;
      const Eigen::Vector2d error =
          pixel -
          scene.TruePixel(scene.tracks.frames[static_cast<std::size_t>(frame)], scene.LandmarkOf(track));
      const bool clamped = pixel.minCoeff() == 0 || pixel.x() == 751 || pixel.y() == 479;
      ASSERT_TRUE(clamped || (error - (wrong ? fault.jump_px : Eigen::Vector2d(0, 0))).norm() < 6) << track;
      jumped += wrong ? 1 : 0;
    }
    if (fault.wrong) {
      EXPECT_GE(fault.onset, 1);
      EXPECT_GE(fault.jump_px.norm(), 10);
      EXPECT_LE(fault.jump_px.norm(), 30);
    }
  }
  EXPECT_GT(jumped, 1000);
}

TEST(SimFaultTest, ATrackOfUniformPixelsFillsTheImage) {
  const SimScene scene(WithOutlierTracks(SimOutlierKind::kUniform, 0.2), kSeed);
  ExpectRateOfLongTracks(scene);
  Eigen::Vector2d sum(0, 0), squares(0, 0);
  double count = 0;
  for (const TrackFrame& frame : scene.tracks.frames) {
    for (const TrackObservation& observation : frame.observations) {
      if (scene.IsOutlier(observation.track_id)) {
        sum += observation.pixel;
        squares += observation.pixel.cwiseAbs2();
        count += 1;
      }
    }
  }
  const Eigen::Vector2d mean = sum / count;
  const Eigen::Vector2d deviation = (squares / count - mean.cwiseAbs2()).cwiseSqrt();
  const Eigen::Vector2d expected = Eigen::Vector2d(751, 479) / std::sqrt(12.0);
  ASSERT_GT(count, 5000);
  EXPECT_LT((mean - Eigen::Vector2d(375.5, 239.5)).cwiseAbs().maxCoeff(), 4 * 217 / std::sqrt(count));
  EXPECT_LT((deviation - expected).cwiseQuotient(expected).cwiseAbs().maxCoeff(), 0.03);
}

TEST(SimFaultTest, TracksThatSwapFollowEachOthersLandmarks) {
  const SimScene scene(WithOutlierTracks(SimOutlierKind::kSwap, 0.3), kSeed);
  std::map<int, int> followed;  // wrong observations by whether some other landmark explains them
  for (const TrackFrame& frame : scene.tracks.frames) {
    if (frame.stamp_ns % 2000000000 != 0) {
      continue;  // every twentieth frame is enough
    }
    for (const TrackObservation& observation : frame.observations) {
      if (!scene.IsOutlier(observation.track_id) || scene.ErrorOf(frame, observation).norm() < 6) {
        continue;
      }
      const bool explained = std::any_of(
          frame.observations.begin(), frame.observations.end(), [&](const TrackObservation& other) {
            return scene.IsOutlier(other.track_id) &&
                   (scene.TruePixel(frame, scene.LandmarkOf(other.track_id)) - observation.pixel).norm() < 6;
          });
      ++followed[explained ? 1 : 0];
    }
  }
  // Its partner may have ended since: then nobody in the frame began on the landmark it follows.
  EXPECT_GT(followed[1], 100);
  EXPECT_GT(followed[1], followed[0]);
}

TEST(SimFaultTest, ATrackThatDriftsSlidesAtItsRate) {
  const SimScene scene(WithOutlierTracks(SimOutlierKind::kDrift, 0.2), kSeed);
  ExpectRateOfLongTracks(scene);
  for (const auto& [track, observations] : scene.ByTrack()) {
    const TrackFault fault = FaultOf(scene, track, observations.front().first);
    const auto& [frame, pixel] = observations.back();
    const double age_s = 0.1 * (frame - observations.front().first);
    const Eigen::Vector2d error =
        pixel -
        scene.TruePixel(scene.tracks.frames[static_cast<std::size_t>(frame)], scene.LandmarkOf(track));
    const Eigen::Vector2d expected = fault.wrong ? age_s * fault.drift_px_per_s : Eigen::Vector2d(0, 0);
    const bool clamped = pixel.minCoeff() == 0 || pixel.x() == 751 || pixel.y() == 479;
    ASSERT_TRUE(clamped || (error - expected).norm() < 6) << track;
  }
}

TEST(SimFaultTest, AMovingLandmarkIsSeenWhereItHasMovedTo) {
  const SimScene scene(WithOutlierTracks(SimOutlierKind::kMoving, 0.2), kSeed);
  ExpectRateOfLongTracks(scene);
  double largest_px = 0;
  for (const auto& [track, observations] : scene.ByTrack()) {
    const TrackFault fault = FaultOf(scene, track, observations.front().first);
    if (!fault.wrong) {
      continue;
    }
    EXPECT_EQ(fault.velocity_W_mps.z(), 0);
    EXPECT_NEAR(fault.velocity_W_mps.norm(), 1, 0.5);
    const auto& [frame, pixel] = observations.back();
    const TrackFrame& last = scene.tracks.frames[static_cast<std::size_t>(frame)];
    const Eigen::Vector3d& start = scene.landmarks[static_cast<std::size_t>(scene.LandmarkOf(track))];
    const double age_s = 0.1 * (frame - observations.front().first);
    const Eigen::Vector3d now = start + age_s * fault.velocity_W_mps;
    ASSERT_LT((pixel - scene.PixelOf(last, now, scene.rig.T_BC)).norm(), 6) << track;
    largest_px = std::max(
        largest_px, (pixel - scene.PixelOf(last, now - 0.1 * fault.velocity_W_mps, scene.rig.T_BC)).norm());
  }
  EXPECT_GT(largest_px, 8) << "the test cannot tell a moving landmark from one that stands";
}

TEST(SimFaultTest, MixedOutliersAreOfEveryKindAlike) {
  const SimulatorConfig config = WithOutlierTracks(SimOutlierKind::kMixed, 0.3);
  const FaultSource source(config, kSeed, "camera");
  std::map<SimOutlierKind, int> kinds;
  int wrong = 0;
  constexpr int kTracks = 20000;
  for (int i = 0; i < kTracks; ++i) {
    const TrackFault fault = source.OfTrack(i % 800, i / 800);
    wrong += fault.wrong ? 1 : 0;
    kinds[fault.kind] += fault.wrong ? 1 : 0;
  }
  EXPECT_NEAR(wrong, 0.3 * kTracks, 4 * std::sqrt(0.21 * kTracks));
  ASSERT_EQ(kinds.size(), 5u);
  for (const auto& [kind, count] : kinds) {
    EXPECT_NEAR(count, wrong / 5.0, 4 * std::sqrt(0.16 * wrong)) << static_cast<int>(kind);
  }
}

TEST(SimFaultTest, SwappedObservationsArePermutedWithinTheirFrame) {
  SimulatorConfig config = MinuteConfig();
  const SimScene clean(config, kSeed);
  config.outlier_rate = 0.1;
  config.outlier_kind = SimOutlierKind::kSwap;
  const SimScene swapped(config, kSeed);
  double moved = 0, count = 0;
  for (std::size_t k = 0; k < clean.tracks.frames.size(); ++k) {
    const auto& before = clean.tracks.frames[k].observations;
    const auto& after = swapped.tracks.frames[k].observations;
    ASSERT_EQ(before.size(), after.size());
    std::multiset<double> pixels_before, pixels_after;
    for (std::size_t i = 0; i < before.size(); ++i) {
      ASSERT_EQ(before[i].track_id, after[i].track_id);
      pixels_before.insert(before[i].pixel.x());
      pixels_after.insert(after[i].pixel.x());
      const bool is_moved = before[i].pixel != after[i].pixel;
      EXPECT_TRUE(!is_moved || swapped.IsOutlier(after[i].track_id));
      moved += is_moved ? 1 : 0;
      count += 1;
    }
    EXPECT_EQ(pixels_before, pixels_after);
  }
  EXPECT_NEAR(moved / count, 0.1, 4 * std::sqrt(0.09 / count));
}

TEST(SimFaultTest, UniformObservationsComeAtTheirRate) {
  SimulatorConfig config = MinuteConfig();
  config.outlier_rate = 0.1;
  config.outlier_kind = SimOutlierKind::kUniform;
  const SimScene scene(config, kSeed);
  double far = 0, count = 0;
  for (const TrackFrame& frame : scene.tracks.frames) {
    for (const TrackObservation& observation : frame.observations) {
      far += scene.ErrorOf(frame, observation).norm() > 6 ? 1 : 0;
      count += 1;
    }
  }
  EXPECT_NEAR(far / count, 0.1, 4 * std::sqrt(0.09 / count));
}

TEST(SimFaultTest, APullGrowsHorizontallyAndThenStays) {
  SimulatorConfig config;
  config.fault = SimFaultKind::kGnssRamp;
  config.fault_start_s = 20;
  config.fault_duration_s = 10;
  const SimPull pull(config, kSeed);
  EXPECT_TRUE(pull.moves_rates());
  EXPECT_EQ(pull.At(20).norm(), 0);
  EXPECT_NEAR(pull.At(24).norm(), 2, 1e-12);
  EXPECT_NEAR(pull.At(50).norm(), 5, 1e-12);
  EXPECT_EQ(pull.At(50).z(), 0);
  config.fault = SimFaultKind::kBlackout;
  EXPECT_EQ(SimPull(config, kSeed).At(50).norm(), 0);
}

TEST(SimFaultTest, MissingFramesAndAClockThatJumpedLeaveTheOthersAlone) {
  SimulatorConfig config = MinuteConfig();
  config.duration_s = 40;
  const Result<Dataset> clean = Simulate(config, kSeed);
  config.fault = SimFaultKind::kFrameDrops;
  config.fault_start_s = 0;
  config.fault_duration_s = 1e4;
  const Result<Dataset> dropped = Simulate(config, kSeed);
  config.fault = SimFaultKind::kCameraClock;
  config.fault_start_s = 20;
  const Result<Dataset> jumped = Simulate(config, kSeed);
  const auto frames = static_cast<double>(clean->frames.size());
  EXPECT_NEAR(1 - static_cast<double>(dropped->frames.size()) / frames, 0.1, 0.06);
  ASSERT_EQ(jumped->frames.size(), clean->frames.size());
  const TimeNs start_ns = clean->imu.front().stamp_ns;
  for (std::size_t i = 0; i < clean->frames.size(); ++i) {
    const TimeNs stamp_ns = clean->frames[i].stamp_ns;
    const bool later = SecondsBetween(start_ns, stamp_ns) >= 20;
    EXPECT_EQ(jumped->frames[i].stamp_ns, stamp_ns + (later ? SecondsToNs(1) : 0));
  }
}

}  // namespace
}  // namespace alidade
