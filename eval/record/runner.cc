#include "eval/record/runner.h"

#include "eval/record/log_player.h"
#include "filter/filter.h"

namespace alidade {
namespace {

/// Both lists ascend in time; a frame that was lost may be in one of them alone.
void AttachAudit(const std::vector<ObservabilityRecord>& audited, RunResult* result) {
  size_t next = 0;
  for (RunRecord& record : result->records) {
    while (next < audited.size() && audited[next].stamp_ns < record.estimate.stamp_ns) {
      ++next;
    }
    if (next < audited.size() && audited[next].stamp_ns == record.estimate.stamp_ns) {
      record.observability = audited[next];
    }
  }
}

}  // namespace

RunResult RunEstimator(const EstimatorConfig& config, const MeasurementLog& log, const RunOptions& options,
                       Estimator* estimator) {
  const LogTables tables = TablesOf(log);
  return LogPlayer(config, log, tables, options, estimator).Play();
}

RunResult RunEstimator(const EstimatorConfig& config, const MeasurementLog& log, const RunOptions& options) {
  return RunEstimator(config, log, TablesOf(log), options);
}

RunResult RunEstimator(const EstimatorConfig& config, const MeasurementLog& log, const LogTables& tables,
                       const RunOptions& options) {
  if (options.audit && config.calibration.any()) {
    RunResult refused;
    refused.status = Status::Config(
        "calibration: the audit does not support camera parameters; expected extrinsics, time_offset and "
        "intrinsics false");
    return refused;
  }
  if (options.audit && config.backend == Backend::kFilter) {
    ObservabilityAudit audit;
    EstimatorConfig unwatched = config;
    unwatched.calibration.watch = false;
    const std::unique_ptr<Estimator> filter = MakeFilter(unwatched, log.rig, &audit);
    RunResult result = LogPlayer(unwatched, log, tables, options, filter.get()).Play();
    AttachAudit(audit.records(), &result);
    return result;
  }
  const std::unique_ptr<Estimator> estimator = MakeEstimator(config, log.rig);
  return LogPlayer(config, log, tables, options, estimator.get()).Play();
}

RunResult RunEstimator(const EstimatorConfig& config, const MeasurementLog& log, const Trajectory* truth,
                       unsigned seed) {
  RunOptions options;
  options.truth = truth;
  options.seed = seed;
  return RunEstimator(config, log, options);
}

}  // namespace alidade
