#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/estimator/estimator.h"
#include "eval/audit/observability.h"
#include "eval/record/calibration_record.h"
#include "eval/run/session_event.h"
#include "eval/trajectory/trajectory.h"
#include "gnss/model/gnss_epoch.h"

namespace alidade {

/// One processed frame of a run.
struct RunRecord {
  NavEstimate estimate;
  FrameStatistics statistics;
  double frontend_ms = 0;
  double backend_ms = 0;  ///< wall time of the estimator for this frame and the IMU samples before it
  std::string status = "ok";
  std::optional<ObservabilityRecord> observability;  ///< of an audited run
  /// Covariance of (phi, dp) given the data up to this frame alone; of the batch estimate.
  std::optional<Matrix6d> filtering_covariance;
  std::optional<ClockState> clock;                 ///< once aligned with GNSS
  std::optional<CalibrationEstimate> calibration;  ///< of an estimator that calibrates online
  std::string reason;                              ///< of a status that is not ok
};

/// A time without an estimate.
struct Restart {
  TimeNs lost_ns = 0;       ///< IMU time of the frame or epoch at which the estimate was given up
  std::string reason;       ///< why
  TimeNs restarted_ns = 0;  ///< stamp of the new start; 0 when there was none
  std::string init_report;  ///< what the initialiser found
};

struct RunResult {
  Status status;                   ///< kDiverged when never initialised or lost; records hold what there was
  std::vector<RunRecord> records;  ///< one a frame since initialisation
  std::string init_method;         ///< truth | static | dynamic
  std::string init_report;         ///< what the initialiser found, or why it did not initialise
  TimeNs init_stamp_ns = 0;
  int frames_skipped = 0;                     ///< refused by the estimator after initialisation
  std::string skip_report;                    ///< why the first of them was
  int imu_rejected = 0;                       ///< samples dropped by the reader or refused by the run
  std::optional<GlobalFrame> global;          ///< once aligned with GNSS or position fixes
  std::string align_report;                   ///< what the alignment found, or why it did not
  int epochs_used = 0;                        ///< GNSS epochs the estimator took
  PerSensor<int> skipped;                     ///< epochs and measurements that were refused, not gated
  std::vector<GnssResiduals> gnss_residuals;  ///< of the used epochs
  std::vector<Restart> restarts;
  /// Of the last calibration, when the true one is known.
  std::optional<CalibrationError> calibration_error;
  bool interrupted = false;
  double wall_s = 0;
  double cpu_s = 0;  ///< of the running thread
};

/// ok | diverged | not_initialized | interrupted | failed: one word for tables.
[[nodiscard]] std::string StatusWord(const RunResult& result);

/// The rows of a result as a trajectory with covariance.
[[nodiscard]] Trajectory TrajectoryOf(const RunResult& result);

}  // namespace alidade
