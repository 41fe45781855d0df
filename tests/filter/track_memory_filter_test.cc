#include <gtest/gtest.h>

#include "filter/filter.h"
#include "filter/filter_estimator.h"
#include "tests/support/scenario.h"
#include "tests/support/sliding_tracks.h"

namespace alidade {
namespace {

using Eigen::Vector3d;

/// One standard deviation off in velocity and biases, as a sensor sheet leaves them.
NavEstimate UncertainStart(const Dataset& dataset, unsigned seed) {
  NavEstimate initial = test::DrawInitialState(dataset, seed);
  initial.covariance.diagonal().segment<3>(6).setConstant(0.05 * 0.05);
  initial.covariance.diagonal().segment<3>(9).setConstant(5e-3 * 5e-3);
  initial.covariance.diagonal().segment<3>(12).setConstant(0.1 * 0.1);
  initial.nav.v_WB += Vector3d(0.05, -0.05, 0.05);
  initial.bias.gyro += Vector3d(5e-3, 5e-3, -5e-3);
  initial.bias.accel += Vector3d(0.1, -0.1, 0.1);
  return initial;
}

TEST(TrackMemoryFilterTest, MemoryBeyondTheWindowBeatsTheWindowAlone) {
  SimulatorConfig sim;
  sim.duration_s = 60;
  sim.path_m = 78.6;
  EstimatorConfig config;
  config.filter.window = 11;
  config.filter.min_observations = 5;
  config.filter.clone_policy = ClonePolicy::kOldest;
  config.filter.memory_depth_deviation = 0.05;
  double sum[2] = {0, 0};
  double nees = 0;
  for (const unsigned seed : {1U, 2U, 3U}) {
    const Dataset dataset = test::SimulateOrDie(sim, seed);
    for (const TrackMemoryPolicy policy : {TrackMemoryPolicy::kWindow, TrackMemoryPolicy::kCarry}) {
      config.filter.track_memory = policy;
      const std::unique_ptr<Estimator> filter = MakeFilter(config, dataset.rig);
      const test::ScenarioResult result =
          test::RunScenario(dataset, test::DrawInitialState(dataset, seed), filter.get());
      ASSERT_TRUE(result.status.ok()) << result.status.message();
      sum[policy == TrackMemoryPolicy::kCarry ? 1 : 0] += result.rmse_orientation_rad;
      nees += policy == TrackMemoryPolicy::kCarry ? result.nees_pose / 3 : 0;
    }
  }
  EXPECT_LT(sum[1], 0.8 * sum[0]);
  EXPECT_LT(nees, 10);
}

// GIVEN tracks of little noise, a tenth of which slide over their surface more slowly than the gate sees WHEN
// they are followed far beyond the window THEN their memories end, and the filter does not trust the slide.
TEST(TrackMemoryFilterTest, TracksThatSlideBelowTheGateAreNotRemembered) {
  const Dataset dataset =
      test::SlidingTracks(4, {"duration_s=60", "path_m=75", "outlier_rate=0.1", "outlier_px=1"});
  EstimatorConfig config;
  config.vision.pixel_noise_px = 0.5;
  config.filter.update = UpdateTiming::kDelayedAll;
  config.filter.min_observations = 4;
  config.filter.update_iterations = 12;
  config.filter.max_direction_deviation = 0.2;
  config.filter.track_memory = TrackMemoryPolicy::kCarry;
  config.filter.memory_depth_deviation = 0.03;
  config.filter.clone_policy = ClonePolicy::kOldest;
  const std::unique_ptr<Estimator> filter = MakeFilter(config, dataset.rig);
  const test::ScenarioResult result =
      test::RunScenario(dataset, test::DrawInitialState(dataset, 4), filter.get());
  ASSERT_TRUE(result.status.ok()) << result.status.message();
  EXPECT_LT(result.nees_pose, 40);
}

// GIVEN a start as uncertain as a sensor sheet leaves it, landmarks within a metre WHEN the window fills THEN
// tracks with a memory have corrected the state long before, where a delayed update comes too late to be
// linear.
TEST(TrackMemoryFilterTest, AnUncertainStartDoesNotWaitForTheWindowToFill) {
  const Result<SimulatorConfig> sim =
      LoadSimulatorConfig(ALIDADE_SOURCE_DIR "/configs/datasets/wander.yaml", {"duration_s=20", "path_m=26"});
  ASSERT_TRUE(sim.ok()) << sim.message();
  const Dataset dataset = test::SimulateOrDie(*sim, 1);
  EstimatorConfig config;
  config.filter.update = UpdateTiming::kDelayedAll;
  config.filter.clone_policy = ClonePolicy::kOldest;
  config.filter.memory_depth_deviation = 0.05;
  const auto nees = [&](TrackMemoryPolicy policy) {
    config.filter.track_memory = policy;
    FilterEstimator filter(config, dataset.rig);
    const test::ScenarioResult result = test::RunScenario(dataset, UncertainStart(dataset, 1), &filter);
    EXPECT_TRUE(result.status.ok()) << result.status.message();
    return result.nees_pose;
  };
  const double with_memory = nees(TrackMemoryPolicy::kCarry);
  EXPECT_LT(with_memory, 12);
  EXPECT_GT(nees(TrackMemoryPolicy::kNone), 2 * with_memory);
}

// GIVEN a walk at 0.1 m/s and a start whose velocity is known to 0.05 m/s THEN the first corrections are as
// large as the motion itself: tracks that wait for a depth leave it too late, single ones are those whose
// noise looks like parallax, and one linearisation is not enough.
TEST(TrackMemoryFilterTest, AStartLessCertainThanTheMotionIsLinearisedAgainAndWithMostTracks) {
  const Result<SimulatorConfig> sim = LoadSimulatorConfig(
      ALIDADE_SOURCE_DIR "/configs/datasets/figure8.yaml",
      {"trajectory=hover", "duration_s=10", "length_m=0.6", "width_m=0.4", "height_m=0.2", "path_m=1"});
  ASSERT_TRUE(sim.ok()) << sim.message();
  EstimatorConfig config;
  config.filter.update = UpdateTiming::kDelayedAll;
  config.filter.window = 25;
  config.filter.min_observations = 4;
  config.filter.clone_policy = ClonePolicy::kSpread;
  config.filter.track_memory = TrackMemoryPolicy::kCarry;
  config.filter.memory_depth_deviation = 0.03;
  config.vision.rest_updates = false;  // they would bound the velocity while the walk pauses
  const auto nees = [&](int iterations, double max_direction_deviation) {
    config.filter.update_iterations = iterations;
    config.filter.max_direction_deviation = max_direction_deviation;
    constexpr unsigned kRuns = 12;
    double sum = 0;
    for (unsigned seed = 1; seed <= kRuns; ++seed) {
      const Dataset dataset = test::SimulateOrDie(*sim, seed);
      FilterEstimator filter(config, dataset.rig);
      NavEstimate initial = UncertainStart(dataset, seed);
      initial.covariance.diagonal().segment<2>(0).setConstant(0.01 * 0.01);
      const test::ScenarioResult result = test::RunScenario(dataset, initial, &filter);
      EXPECT_TRUE(result.status.ok()) << result.status.message();
      sum += result.nees_pose;
    }
    return sum / kRuns;
  };
  const double right = nees(12, 0.2);
  EXPECT_LT(right, 15);
  EXPECT_GT(nees(1, 0), 3 * right);
  EXPECT_GT(nees(12, 0), 2.5 * right);
}

}  // namespace
}  // namespace alidade
