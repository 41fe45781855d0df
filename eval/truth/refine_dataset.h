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
  bool imu_scale = false;                   ///< estimate the scale factors of the IMU
  TruthNoise noise;                         ///< of the poses; what is not positive is estimated
  const std::atomic<bool>* stop = nullptr;  ///< may be null
};

/// RefineTruth over the IMU of a sequence and its truth. Errors: those of RefineTruth; kInput: no truth, or
/// one without orientation; kUsage: imu.noise is not that of the sheet.
Result<RefinedTruth> RefineDataset(const Dataset& dataset, const RefineOptions& options);

/// The refined states as a truth: velocity, biases and the covariance of every pose.
[[nodiscard]] Trajectory TruthOf(const RefinedTruth& refined);

/// kUsage: the sequence that WriteRefined would write at `output` is that of the folder `dataset`, or one of
/// the two lies within the other's mav0: the recording would be overwritten. kInput: the dataset cannot be
/// read.
Status CheckRefinedOutput(const std::string& dataset, const std::string& output);

/// Writes the folder of a sequence with its refined truth: sensors and tables of `dataset.path` are copied,
/// folders of images (`data`) become links, and the truth stands in state_groundtruth_estimate0. Where scale
/// factors of the IMU were estimated its samples are multiplied by them. Errors: those of CheckRefinedOutput;
/// kOutput.
Status WriteRefined(const Dataset& dataset, const RefinedTruth& refined, const std::string& output);

}  // namespace alidade
