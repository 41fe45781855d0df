#include <gtest/gtest.h>

#include "tests/support/preset_run.h"

// Driving: landmarks ahead are seen longest, and their images move least.

namespace alidade {
namespace {

/// Mean of the runs of `alidade_smoother` from seeds 575 and 576.
test::ScenarioResult Smooth(const SimulatorConfig& sim) {
  test::ScenarioResult mean;
  for (const unsigned seed : {575U, 576U}) {
    const test::ScenarioResult run =
        test::RunPreset("alidade_smoother", {}, test::SimulateOrDie(sim, seed), seed);
    mean.nees_pose += run.nees_pose / 2;
    mean.scale += run.scale / 2;
  }
  return mean;
}

// GIVEN an almost straight path at 15 m/s with landmarks ahead THEN the scale does not drift: the prior's
// landmarks do not move with it.
TEST(Drive, LandmarksInThePriorDoNotBendTheScale) {
  SimulatorConfig sim;
  sim.duration_s = 60;
  sim.length_m = 2000;
  sim.width_m = 1000;
  sim.height_m = 20;
  sim.path_m = 900;
  sim.camera_rate_hz = 10;
  sim.imu_rate_hz = 200;
  sim.landmark_min_distance_m = 4;
  sim.landmark_max_distance_m = 60;
  sim.max_range_m = 90;
  sim.landmark_count = 20000;
  const test::ScenarioResult mean = Smooth(sim);
  EXPECT_LT(mean.nees_pose, 8);
  EXPECT_NEAR(mean.scale, 1, 0.01);
}

// GIVEN a bend at 10 m/s, where the IMU tells the scale, THEN it is as certain as the covariance says.
TEST(Drive, OnABendTheCovarianceHolds) {
  SimulatorConfig sim;
  sim.trajectory = SimTrajectory::kEllipse;
  sim.duration_s = 50;
  sim.length_m = 500;
  sim.width_m = 300;
  sim.height_m = 10;
  sim.path_m = 500;
  sim.camera_rate_hz = 20;
  sim.imu_rate_hz = 200;
  sim.landmark_min_distance_m = 5;
  sim.landmark_max_distance_m = 50;
  sim.max_range_m = 80;
  sim.landmark_count = 8000;
  const test::ScenarioResult mean = Smooth(sim);
  EXPECT_LT(mean.nees_pose, 10);
  EXPECT_NEAR(mean.scale, 1, 0.005);
}

}  // namespace
}  // namespace alidade
