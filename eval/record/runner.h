#pragma once

#include <atomic>
#include <functional>

#include "estimator/estimator.h"
#include "estimator/measurement_log.h"
#include "eval/record/run_result.h"
#include "eval/run/make_estimator.h"

namespace alidade {

struct RunOptions {
  const Trajectory* truth = nullptr;         ///< read only by init.method truth
  const RigCalibration* true_rig = nullptr;  ///< what online calibration is compared with; may be null
  unsigned seed = 1;                         ///< draws the prior of init.method truth
  /// Takes the place of truth for init.method truth: the first state at a frame's IMU time.
  std::function<Result<NavEstimate>(TimeNs imu_ns)> start_state;
  const std::atomic<bool>* stop = nullptr;  ///< polled once a frame
  std::function<void(size_t frames_done, size_t frames)> progress;
  /// Fills RunRecord::observability when the back end is the filter. Its time counts as the estimator's.
  bool audit = false;
};

/// Hands the log to a Session (eval/run/session.h) with `estimator`, in time order: before each frame every
/// IMU sample up to and including the first one at or after the frame's IMU time (stamp + time offset); the
/// frame that yields the initial state is also the first one added. With GNSS (gnss.enabled, and the log has
/// it) epochs come in between in the order of IMU time, after a frame of the same stamp, and so do position
/// fixes (fix.enabled); those before the alignment go to the aligner alone and never hold up a frame. Without
/// frames there is a record an epoch. At the end of the log an estimator that looks back replaces its records
/// (Estimator::TakeFinalized).
[[nodiscard]] RunResult RunEstimator(const EstimatorConfig& config, const MeasurementLog& log,
                                     const RunOptions& options, Estimator* estimator);

/// The same with the back end that `config` names.
[[nodiscard]] RunResult RunEstimator(const EstimatorConfig& config, const MeasurementLog& log,
                                     const RunOptions& options);
[[nodiscard]] RunResult RunEstimator(const EstimatorConfig& config, const MeasurementLog& log,
                                     const Trajectory* truth, unsigned seed);

}  // namespace alidade
