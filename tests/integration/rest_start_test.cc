#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "eval/config/config_yaml.h"
#include "filter/filter.h"
#include "smoother/sliding/smoother.h"
#include "tests/support/scenario.h"

namespace alidade {
namespace {

// GIVEN a rig at rest whose state is known as well as its prior says, the gyroscope's bias to 5e-3 rad/s,
// WHEN it moves off after some seconds THEN both back ends have not drifted meanwhile.
TEST(RestStart, AnUncertainBiasDoesNotHideRest) {
  SimulatorConfig sim;
  sim.rest_s = 5;
  sim.duration_s = 15;
  sim.path_m = 13;
  for (const std::string preset : {"alidade_filter", "alidade_smoother"}) {
    const Result<EstimatorConfig> config =
        LoadEstimatorConfig(ALIDADE_SOURCE_DIR "/configs/estimators/" + preset + ".yaml", {});
    ASSERT_TRUE(config.ok()) << config.message();
    for (const unsigned seed : {411U, 412U, 413U}) {
      const Dataset dataset = test::SimulateOrDie(sim, seed);
      const std::unique_ptr<Estimator> estimator = config->backend == Backend::kFilter
                                                       ? MakeFilter(*config, dataset.rig)
                                                       : MakeSmoother(*config, dataset.rig);
      constexpr double kScale = 2.5;
      NavEstimate initial = test::DrawInitialState(dataset, seed, kScale);
      initial.covariance *= kScale * kScale;
      const test::ScenarioResult result = test::RunScenario(dataset, initial, estimator.get());
      ASSERT_TRUE(result.status.ok()) << result.status.message();
      EXPECT_LT(result.nees_pose, 20) << preset << ", seed " << seed;
      EXPECT_LT(result.rmse_position_m, 0.15) << preset << ", seed " << seed;
    }
  }
}

}  // namespace
}  // namespace alidade
