#include <gtest/gtest.h>

#include "tests/support/preset_run.h"

// Driving: landmarks ahead are seen longest, and their images move least.

namespace alidade {
namespace {

/// Mean of the runs of `alidade_smoother` from seeds 575 and 576.
test::ScenarioResult Smooth(const std::vector<std::string>& motion) {
  const Result<SimulatorConfig> sim =
      LoadSimulatorConfig(ALIDADE_SOURCE_DIR "/configs/datasets/figure8.yaml", motion);
  EXPECT_TRUE(sim.ok()) << sim.message();
  test::ScenarioResult mean;
  if (!sim.ok()) {
    return mean;
  }
  for (const unsigned seed : {575U, 576U}) {
    const test::ScenarioResult run =
        test::RunPreset("alidade_smoother", {}, test::SimulateOrDie(*sim, seed), seed);
    mean.nees_pose += run.nees_pose / 2;
    mean.scale += run.scale / 2;
  }
  return mean;
}

// GIVEN an almost straight path at 15 m/s with landmarks ahead THEN the scale does not drift: the prior's
// landmarks do not move with it.
TEST(Drive, LandmarksInThePriorDoNotBendTheScale) {
  const test::ScenarioResult mean =
      Smooth({"duration_s=60", "length_m=2000", "width_m=1000", "height_m=20", "path_m=900",
              "camera_rate_hz=10", "imu_rate_hz=200", "landmark_min_distance_m=4",
              "landmark_max_distance_m=60", "max_range_m=90", "landmark_count=20000"});
  EXPECT_LT(mean.nees_pose, 8);
  EXPECT_NEAR(mean.scale, 1, 0.01);
}

// GIVEN a bend at 10 m/s, where the IMU tells the scale, THEN it is as certain as the covariance says.
TEST(Drive, OnABendTheCovarianceHolds) {
  const test::ScenarioResult mean =
      Smooth({"trajectory=ellipse", "duration_s=50", "length_m=500", "width_m=300", "height_m=10",
              "path_m=500", "camera_rate_hz=20", "imu_rate_hz=200", "landmark_min_distance_m=5",
              "landmark_max_distance_m=50", "max_range_m=80", "landmark_count=8000"});
  EXPECT_LT(mean.nees_pose, 10);
  EXPECT_NEAR(mean.scale, 1, 0.005);
}

}  // namespace
}  // namespace alidade
