#pragma once

#include "core/estimator/estimator.h"
#include "core/estimator/measurement_log.h"
#include "eval/dataset/log_tables.h"
#include "eval/record/run_options.h"
#include "eval/record/run_result.h"
#include "eval/run/make_estimator.h"

namespace alidade {

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
/// The same with the log's long tables elsewhere.
[[nodiscard]] RunResult RunEstimator(const EstimatorConfig& config, const MeasurementLog& log,
                                     const LogTables& tables, const RunOptions& options);

}  // namespace alidade
