#pragma once

#include "eval/simulation/simulator_config.h"
#include "tests/eval/record/estimator_runs.h"

namespace alidade::test {

/// A figure-8 at 4 m/s with a camera, on GPST; without a receiver.
inline SimulatorConfig GnssScene(double duration_s) {
  SimulatorConfig config;
  config.start_time_s = 1700000000;
  config.duration_s = duration_s;
  config.length_m = 60;
  config.width_m = 30;
  config.height_m = 3;
  config.path_m = 4 * duration_s;
  config.landmark_count = 2000;
  config.landmark_max_distance_m = 20;
  config.max_features = 60;
  return config;
}

/// Uses GNSS whose corrections are exact, as they are in a simulation.
inline EstimatorConfig GnssEstimator(Backend backend) {
  EstimatorConfig config = CarryingEstimator(backend);
  config.filter.window = 12;
  config.smoother.landmark = SmootherLandmark::kPoseOnly;
  config.gnss.enabled = true;
  config.gnss.corrections.model_std_scale = 0;
  config.gnss.corrections.pseudorange_std_m = 0.5;
  return config;
}

/// Started at the truth.
inline RunResult RunWithSensors(const EstimatorConfig& config, const Dataset& dataset, unsigned seed) {
  RunOptions options;
  options.truth = &*dataset.truth;
  options.seed = seed;
  return RunEstimator(config, {dataset.rig, dataset.imu, dataset.frames, {}, dataset.gnss, dataset.fixes},
                      options);
}

}  // namespace alidade::test
