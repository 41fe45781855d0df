#include <gtest/gtest.h>

#include "tests/support/preset_run.h"

namespace alidade {
namespace {

class NoiseRatios : public ::testing::TestWithParam<const char*> {};

INSTANTIATE_TEST_SUITE_P(BackEnds, NoiseRatios, ::testing::Values("alidade_filter", "alidade_smoother"));

// GIVEN observations whose noise differs by the factor e in either direction WHEN an estimator is told the
// noise of each THEN its covariance holds, and it is more accurate than with the root mean square for all.
TEST_P(NoiseRatios, AreUsedAsWeights) {
  SimulatorConfig sim;
  sim.duration_s = 20;
  sim.path_m = 26;
  sim.noise_ratio_spread = 1;
  const std::string root_mean_square = "vision.pixel_noise_px=2.718";
  double nees = 0, told_m = 0, untold_m = 0;
  for (const unsigned seed : {71U, 72U}) {
    const Dataset dataset = test::SimulateOrDie(sim, seed);
    const test::ScenarioResult told =
        test::RunPreset(GetParam(), {"vision.noise_ratios=true"}, dataset, seed);
    const test::ScenarioResult untold = test::RunPreset(GetParam(), {root_mean_square}, dataset, seed);
    nees += told.nees_pose / 2;
    told_m += told.rmse_position_m / 2;
    untold_m += untold.rmse_position_m / 2;
  }
  EXPECT_GT(nees, 3);
  EXPECT_LT(nees, 10);
  EXPECT_LT(told_m, 0.85 * untold_m);
}

}  // namespace
}  // namespace alidade
