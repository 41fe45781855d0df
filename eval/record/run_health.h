#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "core/estimator/measurement_log.h"
#include "core/estimator_config.h"
#include "eval/dataset/dataset.h"
#include "eval/record/run_result.h"

namespace alidade {

/// The largest share of frames after the start that may be without a sound state (degraded by data, suspect,
/// lost or skipped) in a run that counts as unimpaired: that of the images that a sequence may lack, so that
/// a short fault, which the IMU bridges, does not fail a run. A clean sequence has none (docs/faults.md).
inline constexpr double kMaxImpairedShare = kMaxUnreadableShare;
/// The same of frames that are degraded because the model is in doubt. Nothing is missing: the covariance is
/// too small. Sheets of real sensors are off by a few per cent, which shows in some motions; what is reported
/// in most of a run is not its model.
inline constexpr double kMaxDoubtedShare = 0.5;

/// How far a run that ended had what its estimator needs.
struct RunHealth {
  std::map<std::string, std::size_t> states;  ///< by RunRecord::status; those of every run are always there
  std::size_t doubted = 0;                    ///< of the degraded ones, those by DegradationKind::kModel
  double unsound_s = 0;  ///< from the record before to each that is degraded, suspect or lost, summed
  /// Why the run is impaired, for people; empty: it is not.
  std::vector<std::string> impairments;
};

[[nodiscard]] RunHealth HealthOf(const EstimatorConfig& config, const RunResult& result);

/// Names of the sensors that the configuration enables and the log lacks.
[[nodiscard]] std::vector<std::string> MissingSensors(const EstimatorConfig& config,
                                                      const MeasurementLog& log);

/// StatusWord, or "impaired" instead of "ok"; frames, states that are not sound, times and impairments, on
/// one line.
[[nodiscard]] std::string DescribeRun(const RunHealth& health, const RunResult& result);

}  // namespace alidade
