#pragma once

#include <atomic>
#include <string>

#include "core/imu_config.h"
#include "core/status.h"
#include "eval/dataset/dataset.h"
#include "smoother/truth/refined_truth.h"

namespace alidade {

struct RefineOptions {
  ImuConfig imu;
  double truth_rate_hz = 0;                 ///< of the poses that are used: at most; 0: all
  TruthNoise noise;                         ///< of the poses; what is not positive is estimated
  const std::atomic<bool>* stop = nullptr;  ///< may be null
};

/// RefineTruth over the IMU of a sequence and its truth. Errors: those of RefineTruth; kInput: no truth, or
/// one without orientation.
Result<RefinedTruth> RefineDataset(const Dataset& dataset, const RefineOptions& options);

/// The refined states as a truth: velocity, biases and the covariance of every pose.
[[nodiscard]] Trajectory TruthOf(const RefinedTruth& refined);

/// Writes the folder of a sequence with another truth: sensors and tables of `dataset.path` are copied,
/// folders of images (`data`) become links, and `truth` stands in state_groundtruth_estimate0. Errors:
/// kOutput.
Status WriteWithTruth(const Dataset& dataset, const Trajectory& truth, const std::string& output);

}  // namespace alidade
