#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "core/numbers.h"
#include "core/time.h"
#include "eval/metrics/evaluate.h"
#include "eval/metrics/silent_failure.h"
#include "eval/record/run_result.h"
#include "eval/simulation/simulator_config.h"
#include "eval/trajectory/trajectory.h"

namespace alidade {

/// Errors have recovered when they remain small for this time.
inline constexpr double kRecoveryWindowS = 2;
/// Of the position RMSE to that of the run without the fault.
inline constexpr double kRecoveredErrorRatio = 1.5;

/// When the fault of a simulation acts.
struct FaultTimes {
  TimeNs begin_ns = 0;
  /// Of camera_clock, imu_clock and imu_unit, which change all later data, the beginning. Absent: less than
  /// kRecoveryWindowS of the sequence follow.
  std::optional<TimeNs> end_ns;
};
/// `start_ns`: the first IMU sample without the fault; `last_ns`: the end of the sequence.
[[nodiscard]] FaultTimes FaultTimesOf(const SimulatorConfig& config, TimeNs start_ns, TimeNs last_ns);

/// One row of a run and its error.
struct RunInstant {
  ReportedError reported;  ///< its stamp, pose NEES and alarm; NEES NaN where truth or covariance is missing
  bool ok = true;          ///< the status is ok or local
  TimeNs known_ns = 0;     ///< when the status was known: of a lost row, when the estimate was given up
  double nees_position = kNan;
  double error_m = kNan;  ///< position, unaligned
};
/// Every row, with errors as `options` evaluate them; unknown where Evaluate finds too few pairs.
[[nodiscard]] std::vector<RunInstant> InstantsOf(const RunResult& run, const Trajectory& truth,
                                                 const EvaluationOptions& options);

/// How a run reported a fault and recovered from it [s]. NaN: does not apply; kNever: not in this run.
struct FaultFigures {
  static constexpr double kNever = std::numeric_limits<double>::infinity();

  double reported_after_s = kNan;  ///< start of the fault to the first status that is not ok
  /// End of the fault to the first row from which on every status is ok.
  double ok_after_s = kNan;
  /// End of the fault to the first row from which on the pose NEES is within 3 sigma (NeesOfSigmas, 6 degrees
  /// of freedom) for kRecoveryWindowS.
  double covered_after_s = kNan;
  /// End of the fault to the first row from which on the position RMSE over kRecoveryWindowS is below
  /// kRecoveredErrorRatio times that of the clean run over the same time; without a clean run: the position
  /// NEES is within 3 sigma for that time.
  double accurate_after_s = kNan;
  bool beside_clean = false;  ///< there is a clean run
  double silent_s = kNan;     ///< longest silent failure since the start (SilentFailure); NaN without errors
};

/// `run` and `clean` (null: none) ascend in time. Rows more than kLongestSpanStepS apart interrupt a window.
[[nodiscard]] FaultFigures ScoreFault(const std::vector<RunInstant>& run, const FaultTimes& times,
                                      const std::vector<RunInstant>* clean);

}  // namespace alidade
