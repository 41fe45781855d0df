#pragma once

#include <cstdint>
#include <vector>

#include "eval/record/run_options.h"
#include "eval/record/runner.h"

namespace alidade::test {

/// Started from the truth; the filter carries its track memories, as the shipped presets do.
inline EstimatorConfig CarryingEstimator(Backend backend) {
  EstimatorConfig config;
  config.backend = backend;
  config.init.method = InitMethod::kTruth;
  config.filter.update = UpdateTiming::kDelayedAll;
  config.filter.track_memory = TrackMemoryPolicy::kCarry;
  config.filter.clone_policy = ClonePolicy::kOldest;
  return config;
}

struct NamedEstimator {
  const char* name;
  EstimatorConfig config;
};

/// Every kind of landmark of both back ends.
inline std::vector<NamedEstimator> EveryLandmark() {
  EstimatorConfig slam_filter = CarryingEstimator(Backend::kFilter);
  slam_filter.filter.landmark = FilterLandmark::kMsckf;
  slam_filter.filter.track_memory = TrackMemoryPolicy::kNone;
  slam_filter.filter.slam_features = 20;
  EstimatorConfig smoother = CarryingEstimator(Backend::kSmoother);
  smoother.smoother.landmark = SmootherLandmark::kPoseOnly;
  smoother.smoother.slam_features = 20;
  EstimatorConfig inverse_depth = CarryingEstimator(Backend::kSmoother);
  inverse_depth.smoother.landmark = SmootherLandmark::kInverseDepth;
  return {{"filter", CarryingEstimator(Backend::kFilter)},
          {"filter with SLAM features", slam_filter},
          {"smoother", smoother},
          {"smoother with inverse depths", inverse_depth}};
}

inline RunResult RunOn(const EstimatorConfig& config, const Dataset& dataset, std::uint64_t seed) {
  RunOptions options;
  options.truth = &*dataset.truth;
  options.true_rig = dataset.true_rig ? &*dataset.true_rig : nullptr;
  options.seed = seed;
  return RunEstimator(config, {dataset.rig, dataset.imu, dataset.frames}, options);
}

}  // namespace alidade::test
