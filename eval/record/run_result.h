#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "eval/record/record_spool.h"
#include "eval/record/run_record.h"
#include "eval/run/session_event.h"
#include "eval/trajectory/trajectory.h"
#include "gnss/model/gnss_epoch.h"

namespace alidade {

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
  /// Of RunOptions::spool_folder, else null: the records before those of `records`, which are the newest, and
  /// what `gnss_residuals` would hold.
  std::shared_ptr<RecordSpool> spool;
  std::string init_method;  ///< truth | static | dynamic
  std::string init_report;  ///< what the initialiser found, or why it did not initialise
  TimeNs init_stamp_ns = 0;
  int frames_skipped = 0;   ///< refused by the estimator after initialisation
  std::string skip_report;  ///< why the first of them was
  /// Samples dropped by the reader, refused by the run or replaced by the guard (eval/run/imu_guard.h). An
  /// axis that is saturated or stuck counts one an episode, and a change of the gyroscope's unit one,
  /// although their samples are used.
  int imu_rejected = 0;
  /// What the configuration enables and the log lacks (run_health.h).
  std::vector<std::string> missing_sensors;
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

/// The records of a result, wherever they are.
[[nodiscard]] size_t RecordCount(const RunResult& result);
/// Null: there is none.
[[nodiscard]] const RunRecord* FirstRecord(const RunResult& result);
/// Hands each to `take`, in order, up to the first error: of `take` or of the spool.
Status ForEachRecord(const RunResult& result, const std::function<Status(const RunRecord&)>& take);

/// The rows of a result that is held in memory as a trajectory with covariance.
[[nodiscard]] Trajectory TrajectoryOf(const RunResult& result);

}  // namespace alidade
