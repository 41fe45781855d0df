#pragma once

#include <string>
#include <vector>

#include "core/estimator/measurement_log.h"
#include "core/estimator_config.h"
#include "core/status.h"
#include "eval/trajectory/trajectory.h"

namespace alidade {

/// Result of one initialisation within a sequence.
struct StartOutcome {
  std::string sequence;
  TimeNs start_ns = 0;  ///< first frame passed to the initialiser
  bool found = false;
  std::string method;   ///< static | dynamic
  std::string message;  ///< the last rejection, or the report
  double waited_s = 0;  ///< data used, from the first frame on
  // Against truth; NaN where there is none.
  double scale_error = 0;  ///< |size of the window / its true size - 1|; NaN after a static start
  double scale_std = 0;    ///< the same as the start reports it
  double tilt_error_rad = 0;
  double velocity_error_mps = 0;
  double nees = 0;      ///< of tilt and velocity: 5 degrees of freedom; NaN where truth has no velocity
  double nees_all = 0;  ///< of tilt, velocity and biases: 11; NaN where truth has no biases
};

/// Error of an estimate in the canonical chart, after moving the truth onto it in yaw and position, which are
/// a choice of frame.
[[nodiscard]] Vector15d GaugeFreeError(const NavEstimate& estimate, const TrajectoryPoint& truth);

/// Passes the log to a new initializer from the first frame at or after `start_ns` on, until it finds a state
/// or `limit_s` of data have passed.
StartOutcome StartAt(const EstimatorConfig& config, const MeasurementLog& log, const Trajectory& truth,
                     TimeNs start_ns, double limit_s);

/// `count` starts, uniform over the frames that leave `limit_s` of the log, drawn with `seed` from the stream
/// named after the sequence.
std::vector<StartOutcome> StartOften(const EstimatorConfig& config, const MeasurementLog& log,
                                     const Trajectory& truth, const std::string& sequence, int count,
                                     double limit_s, unsigned seed);

/// One row a sequence and one for all: starts, found, waits, scale errors, NEES.
[[nodiscard]] std::string StartTable(const std::vector<StartOutcome>& outcomes);
/// One row a start, with a header.
[[nodiscard]] std::string StartCsv(const std::vector<StartOutcome>& outcomes);

}  // namespace alidade
