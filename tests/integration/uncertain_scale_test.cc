#include <gtest/gtest.h>

#include "tests/support/preset_run.h"

namespace alidade {
namespace {

// GIVEN a walk of 0.1 m/s whose velocity is known to 0.05 m/s at its start, so that the scale is uncertain by
// half, WHEN the window changes its shape with every correction THEN the filter does not take that for
// knowledge of the scale.
TEST(UncertainScale, CorrectionsDoNotRevealIt) {
  SimulatorConfig sim;
  sim.duration_s = 25;
  sim.length_m = 3;
  sim.width_m = 1.5;
  sim.height_m = 0.15;
  sim.path_m = 2.5;
  sim.landmark_min_distance_m = 1;
  sim.landmark_max_distance_m = 6;
  sim.pixel_noise_px = 0.7;
  for (const unsigned seed : {527U, 528U, 530U}) {
    const Dataset dataset = test::SimulateOrDie(sim, seed);
    const test::ScenarioResult result =
        test::RunPreset("alidade_filter", {"vision.pixel_noise_px=0.7"}, dataset, seed, 5);
    EXPECT_LT(result.nees_pose, 20) << "seed " << seed;
  }
}

// GIVEN an accelerometer that is clipped, so that it says little about the scale, THEN likewise: the scale is
// never uncertain by a tenth there, but corrections would reveal it over a minute.
TEST(UncertainScale, CorrectionsDoNotRevealItWhereTheAccelerometerIsClipped) {
  SimulatorConfig sim;
  sim.duration_s = 40;
  sim.path_m = 52;
  sim.fault = SimFaultKind::kAccelSaturation;
  sim.fault_start_s = 0;
  sim.fault_duration_s = sim.duration_s;
  for (const unsigned seed : {921U, 922U, 923U}) {
    const Dataset dataset = test::SimulateOrDie(sim, seed);
    EXPECT_LT(test::RunPreset("alidade_filter", {}, dataset, seed).nees_pose, 15) << "seed " << seed;
  }
}

}  // namespace
}  // namespace alidade
