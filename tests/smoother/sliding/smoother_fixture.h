#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <utility>

#include "smoother/sliding/smoother.h"
#include "tests/support/scenario.h"

namespace alidade::test {

struct SequenceOptions {
  double duration_s = 12;
  double pixel_noise_px = 1;
  bool exact = false;  ///< no noise anywhere, start at the truth
  unsigned seed = 1;
};

inline Dataset MakeSequence(const SequenceOptions& options) {
  SimulatorConfig simulator;
  simulator.duration_s = options.duration_s;
  simulator.path_m = 1.3 * options.duration_s;
  simulator.pixel_noise_px = options.exact ? 0 : options.pixel_noise_px;
  const ImuNoise noise = simulator.imu_noise;
  if (options.exact) {
    simulator.imu_noise = {0, 0, 0, 0};
    simulator.imu_rate_hz = 400;
  }
  Result<Dataset> dataset = Simulate(simulator, options.seed);
  EXPECT_TRUE(dataset.ok()) << dataset.message();
  dataset->rig.imu_noise = noise;
  return std::move(dataset).value();
}

inline EstimatorConfig MakeConfig(SmootherLandmark landmark,
                                  ErrorConvention error = ErrorConvention::kRightInvariant) {
  EstimatorConfig config;
  config.backend = Backend::kSmoother;
  config.smoother.landmark = landmark;
  config.smoother.error = error;
  return config;
}

inline ScenarioResult RunSmoother(const Dataset& dataset, const EstimatorConfig& config, bool perturb,
                                  unsigned seed = 1) {
  const std::unique_ptr<Estimator> estimator = MakeSmoother(config, dataset.rig);
  ScenarioResult result =
      RunScenario(dataset, DrawInitialState(dataset, seed, perturb ? 1 : 0), estimator.get());
  EXPECT_TRUE(result.status.ok()) << result.status.message();
  return result;
}

inline constexpr SmootherLandmark kLandmarks[] = {SmootherLandmark::kInverseDepth,
                                                  SmootherLandmark::kPoseOnly};

inline EstimatorConfig WithSlamFeatures(int count) {
  EstimatorConfig config = MakeConfig(SmootherLandmark::kPoseOnly);
  config.smoother.frames = FramePolicy::kEveryFrame;
  config.smoother.slam_features = count;
  return config;
}

}  // namespace alidade::test
