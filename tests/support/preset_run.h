#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "eval/config/config_yaml.h"
#include "eval/run/make_estimator.h"
#include "tests/support/scenario.h"

namespace alidade::test {

/// What a shipped preset makes of `dataset`, started at a draw with `scale` times the deviations of
/// DrawInitialState, with its covariance.
inline ScenarioResult RunPreset(const std::string& preset, const std::vector<std::string>& overrides,
                                const Dataset& dataset, unsigned seed, double scale = 1) {
  const Result<EstimatorConfig> config =
      LoadEstimatorConfig(ALIDADE_SOURCE_DIR "/configs/estimators/" + preset + ".yaml", overrides);
  EXPECT_TRUE(config.ok()) << config.message();
  if (!config.ok()) {
    ScenarioResult refused;
    refused.status = config.status();
    return refused;
  }
  const std::unique_ptr<Estimator> estimator = MakeEstimator(*config, dataset.rig);
  NavEstimate initial = DrawInitialState(dataset, seed, scale);
  initial.covariance *= scale * scale;
  ScenarioResult result = RunScenario(dataset, initial, estimator.get());
  EXPECT_TRUE(result.status.ok()) << preset << ": " << result.status.message();
  return result;
}

}  // namespace alidade::test
