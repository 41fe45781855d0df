#include <gtest/gtest.h>

#include "tests/support/preset_run.h"

// Driving: landmarks ahead are seen longest, and their images move least.

namespace alidade {
namespace {

// GIVEN an almost straight path at 15 m/s with landmarks ahead THEN the scale does not drift: landmarks that
// the camera approaches stay in the prior only while their rows are linear.
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
  double nees = 0, scale = 0;
  for (const unsigned seed : {575U, 576U}) {
    const test::ScenarioResult run =
        test::RunPreset("alidade_smoother", {}, test::SimulateOrDie(sim, seed), seed);
    nees += run.nees_pose / 2;
    scale += run.scale / 2;
  }
  EXPECT_LT(nees, 8);
  EXPECT_NEAR(scale, 1, 0.01);
}

}  // namespace
}  // namespace alidade
