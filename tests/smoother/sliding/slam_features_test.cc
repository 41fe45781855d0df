// Landmarks that stay in the prior of the sliding window.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <vector>

#include "smoother/sliding/smoother_estimator.h"
#include "tests/smoother/sliding/smoother_fixture.h"

namespace alidade {
namespace {

using test::MakeSequence;
using test::RunSmoother;
using test::WithSlamFeatures;

/// Landmarks that a solve of this window may have held: those of the prior that are in sight, and tracks.
int Landmarks(const Window& window) {
  return static_cast<int>(std::count_if(window.tracks().begin(), window.tracks().end(), [](const auto& item) {
    const WindowTrack& track = item.second;
    return track.anchor != nullptr ? !track.views.empty() : track.views.size() >= 2;
  }));
}

// GIVEN a slow motion, WHEN the velocity, and with it the scale of the window, is uncertain, THEN no landmark
// joins the prior; with a known velocity landmarks do.
TEST(SmootherEstimatorTest, LandmarksWaitUntilTheScaleOfTheWindowIsKnown) {
  SimulatorConfig simulator;
  simulator.duration_s = 2;
  simulator.path_m = 1.5;
  const Dataset dataset = test::SimulateOrDie(simulator, 3);
  const auto features = [&](double velocity_std_mps) {
    SmootherEstimator estimator(WithSlamFeatures(60), dataset.rig);
    NavEstimate initial = test::DrawInitialState(dataset, 3);
    initial.covariance.diagonal().segment<3>(6).setConstant(velocity_std_mps * velocity_std_mps);
    const test::ScenarioResult result = test::RunScenario(dataset, initial, &estimator);
    EXPECT_TRUE(result.status.ok()) << result.status.message();
    return std::count_if(estimator.window().tracks().begin(), estimator.window().tracks().end(),
                         [](const auto& item) { return item.second.anchor != nullptr; });
  };
  EXPECT_GT(features(1e-3), 5);
  EXPECT_EQ(features(0.3), 0);
}

// GIVEN outliers, WHEN the gate refuses a landmark of the prior, THEN it is not counted as used besides.
TEST(SmootherEstimatorTest, ARefusedSlamFeatureIsNotCountedAsUsed) {
  SimulatorConfig simulator;
  simulator.duration_s = 8;
  simulator.path_m = 10;
  simulator.outlier_rate = 0.02;
  simulator.outlier_kind = SimOutlierKind::kJump;
  const Dataset dataset = test::SimulateOrDie(simulator, 3);
  SmootherEstimator estimator(WithSlamFeatures(60), dataset.rig);
  ASSERT_TRUE(estimator.Initialize(test::DrawInitialState(dataset, 3)).ok());
  size_t next = 0;
  int refused = 0;
  for (const TrackFrame& frame : dataset.frames) {
    while (next < dataset.imu.size() && (next == 0 || dataset.imu[next - 1].stamp_ns < frame.stamp_ns)) {
      ASSERT_TRUE(estimator.AddImu(dataset.imu[next++]).ok());
    }
    std::vector<std::int64_t> features;
    for (const auto& [id, track] : estimator.window().tracks()) {
      if (track.anchor != nullptr && track.alive) {
        features.push_back(id);
      }
    }
    ASSERT_TRUE(estimator.AddFrame(frame).ok());
    const FrameStatistics& statistics = estimator.last_statistics();
    refused += static_cast<int>(std::count_if(features.begin(), features.end(), [&](std::int64_t id) {
      const auto found = estimator.window().tracks().find(id);
      return found != estimator.window().tracks().end() && found->second.alive &&
             found->second.anchor == nullptr;
    }));
    EXPECT_LE(statistics.features_used, Landmarks(estimator.window()));
  }
  EXPECT_GT(refused, 3);
}

std::int64_t CountSlamFeatures(const Window& window) {
  return std::count_if(window.tracks().begin(), window.tracks().end(),
                       [](const auto& item) { return item.second.anchor != nullptr && item.second.alive; });
}

// GIVEN landmarks in the prior, WHEN images are repeated, THEN most of them stay: no track has ended.
TEST(SmootherEstimatorTest, ARepeatedImageEndsNoSlamFeature) {
  SimulatorConfig simulator;
  simulator.duration_s = 8;
  simulator.path_m = 10;
  const Dataset dataset = test::SimulateOrDie(simulator, 3);
  SmootherEstimator estimator(WithSlamFeatures(60), dataset.rig);
  ASSERT_TRUE(test::RunScenario(dataset, test::DrawInitialState(dataset, 3), &estimator).status.ok());
  const std::int64_t before = CountSlamFeatures(estimator.window());
  ASSERT_GT(before, 5);
  TrackFrame repeated = dataset.frames.back();
  repeated.observations.clear();
  repeated.repeated = true;
  ImuSample sample = dataset.imu.back();
  for (int i = 0; i < 2; ++i) {
    repeated.stamp_ns += 50'000'000;
    while (sample.stamp_ns < repeated.stamp_ns) {
      sample.stamp_ns += 10'000'000;
      ASSERT_TRUE(estimator.AddImu(sample).ok());
    }
    ASSERT_TRUE(estimator.AddFrame(repeated).ok());
    EXPECT_EQ(estimator.Latest().stamp_ns, repeated.stamp_ns);
  }
  EXPECT_GT(2 * CountSlamFeatures(estimator.window()), before);
}

/// Tracks seen in the newest frame and in one up to `stamp_ns`.
std::int64_t CountTracksAcross(const Window& window, TimeNs stamp_ns) {
  return std::count_if(window.tracks().begin(), window.tracks().end(), [&](const auto& item) {
    const std::vector<WindowView>& views = item.second.views;
    return !views.empty() && views.back().frame == &window.newest() &&
           views.front().frame->stamp_ns <= stamp_ns;
  });
}

class FrozenCamera : public testing::TestWithParam<FramePolicy> {};

// GIVEN landmarks in the prior, WHEN an image is repeated more often than the window has frames, THEN the
// frames of the images before stay in the window with their views, and the next image continues the tracks.
TEST_P(FrozenCamera, PushesNoImageOutOfTheWindow) {
  SimulatorConfig simulator;
  simulator.duration_s = 4;
  simulator.path_m = 3;
  const Dataset dataset = test::SimulateOrDie(simulator, 3);
  EstimatorConfig config = WithSlamFeatures(60);
  config.smoother.frames = GetParam();
  SmootherEstimator estimator(config, dataset.rig);
  NavEstimate initial = test::DrawInitialState(dataset, 3);
  initial.covariance.diagonal().segment<3>(6).setConstant(1e-6);
  ASSERT_TRUE(estimator.Initialize(initial).ok());
  const Window& window = estimator.window();
  constexpr size_t kFrozen = 21;  // the first repeated frame
  const size_t seen_again = kFrozen + static_cast<size_t>(config.smoother.window) + 2;
  ASSERT_LT(seen_again, dataset.frames.size());
  const TimeNs last_ns = dataset.frames[kFrozen - 1].stamp_ns;
  int size = 0;
  int landmarks = 0;
  std::int64_t features = 0;
  size_t next = 0;
  for (size_t i = 0; i <= seen_again; ++i) {
    TrackFrame frame = dataset.frames[i];
    if (i >= kFrozen && i < seen_again) {
      frame.observations.clear();
      frame.repeated = true;
    }
    while (next < dataset.imu.size() && (next == 0 || dataset.imu[next - 1].stamp_ns < frame.stamp_ns)) {
      ASSERT_TRUE(estimator.AddImu(dataset.imu[next++]).ok());
    }
    ASSERT_TRUE(estimator.AddFrame(frame).ok());
    ASSERT_EQ(estimator.Latest().stamp_ns, frame.stamp_ns);
    if (i == kFrozen) {
      size = window.size();
      landmarks = Landmarks(window);
      features = CountSlamFeatures(window);
      ASSERT_GT(landmarks, 5);
    }
    if (i >= kFrozen) {
      EXPECT_EQ(window.size(), size) << i;
      EXPECT_LE(window.frame(window.size() - 2).stamp_ns, last_ns) << i;
      EXPECT_GT(2 * Landmarks(window), landmarks) << i;
    }
  }
  EXPECT_GT(CountTracksAcross(window, last_ns), 5);
  // With keyframes no frame has left the window yet that would make features of its tracks.
  EXPECT_EQ(features > 0, GetParam() == FramePolicy::kEveryFrame);
  EXPECT_GE(3 * CountSlamFeatures(window), features);  // those that are in view after 1.2 s
}

INSTANTIATE_TEST_SUITE_P(SmootherEstimatorTest, FrozenCamera,
                         testing::Values(FramePolicy::kEveryFrame, FramePolicy::kKeyframes),
                         [](const testing::TestParamInfo<FramePolicy>& policy) {
                           return policy.param == FramePolicy::kEveryFrame ? "EveryFrame" : "Keyframes";
                         });

// Landmarks change their anchors, are lost and replaced all the time: nothing of it may show on exact data.
TEST(SmootherEstimatorTest, SlamFeaturesLeaveExactDataExact) {
  const Dataset dataset = MakeSequence({.duration_s = 8, .exact = true});
  const test::ScenarioResult run = RunSmoother(dataset, WithSlamFeatures(20), false);
  EXPECT_LT(run.max_position_m, 1e-3);
  const NavState& truth = test::TruthAt(dataset, run.last.stamp_ns).nav;
  EXPECT_LT((run.last.nav.p_WB - truth.p_WB).norm(), 1e-4);
}

// Three runs: the information that outlives the window of one second makes the estimate better, and its
// covariance states by how much.
TEST(SmootherEstimatorTest, SlamFeaturesLowerTheErrorAndKeepTheCovarianceTrue) {
  double with = 0;
  double without = 0;
  double nees = 0;
  for (unsigned seed = 1; seed <= 3; ++seed) {
    const Dataset dataset = MakeSequence({.duration_s = 30, .seed = seed});
    const test::ScenarioResult kept = RunSmoother(dataset, WithSlamFeatures(30), true, seed);
    const test::ScenarioResult lost = RunSmoother(dataset, WithSlamFeatures(0), true, seed);
    with += kept.rmse_orientation_rad;
    without += lost.rmse_orientation_rad;
    nees += kept.nees_pose / 3;
  }
  EXPECT_LT(with, 0.9 * without);
  EXPECT_LT(nees, 12);
}

}  // namespace
}  // namespace alidade
