#include <gtest/gtest.h>

#include <functional>
#include <initializer_list>
#include <memory>
#include <string>
#include <vector>

#include "eval/config/config_yaml.h"
#include "filter/filter.h"
#include "smoother/sliding/smoother.h"
#include "tests/support/scenario.h"

namespace alidade {
namespace {

using StartResult = test::ScenarioResult;

/// Runs of both presets from a start that is drawn with `scale` times the prior's deviations.
void RunStarts(const SimulatorConfig& sim, std::initializer_list<unsigned> seeds, double scale,
               const std::vector<std::string>& overrides,
               const std::function<void(const StartResult&, const std::string&)>& expect) {
  for (const std::string preset : {"alidade_filter", "alidade_smoother"}) {
    const Result<EstimatorConfig> config =
        LoadEstimatorConfig(ALIDADE_SOURCE_DIR "/configs/estimators/" + preset + ".yaml", overrides);
    ASSERT_TRUE(config.ok()) << config.message();
    for (const unsigned seed : seeds) {
      const Dataset dataset = test::SimulateOrDie(sim, seed);
      const std::unique_ptr<Estimator> estimator = config->backend == Backend::kFilter
                                                       ? MakeFilter(*config, dataset.rig)
                                                       : MakeSmoother(*config, dataset.rig);
      NavEstimate initial = test::DrawInitialState(dataset, seed, scale);
      initial.covariance *= scale * scale;
      const StartResult result = test::RunScenario(dataset, initial, estimator.get());
      ASSERT_TRUE(result.status.ok()) << result.status.message();
      expect(result, preset + ", seed " + std::to_string(seed));
    }
  }
}

// GIVEN a rig at rest whose state is known as well as its prior says, the gyroscope's bias to 5e-3 rad/s,
// WHEN it moves off after some seconds THEN both back ends have not drifted meanwhile.
TEST(RestStart, AnUncertainBiasDoesNotHideRest) {
  SimulatorConfig sim;
  sim.rest_s = 5;
  sim.duration_s = 15;
  sim.path_m = 13;
  RunStarts(sim, {411, 412, 413}, 2.5, {}, [](const StartResult& result, const std::string& run) {
    EXPECT_LT(result.nees_pose, 20) << run;
    EXPECT_LT(result.rmse_position_m, 0.15) << run;
  });
}

// GIVEN a rig that moves off from rest before scenery so far that the images show it half a second later THEN
// no zero velocity is measured meanwhile.
TEST(RestStart, FarSceneryDoesNotHideTheBeginningOfMotion) {
  SimulatorConfig sim;
  sim.rest_s = 2;
  sim.rest_ramp_s = 2;
  sim.duration_s = 12;
  sim.path_m = 12;
  sim.camera_rate_hz = 20;
  sim.focal_px = 260;
  sim.pixel_noise_px = 1.5;
  sim.landmark_min_distance_m = 10;
  sim.landmark_max_distance_m = 60;
  sim.max_range_m = 100;
  RunStarts(
      sim, {414, 415, 416}, 1, {"vision.pixel_noise_px=1.5"},
      [](const StartResult& result, const std::string& run) { EXPECT_LT(result.nees_pose, 15) << run; });
}

}  // namespace
}  // namespace alidade
