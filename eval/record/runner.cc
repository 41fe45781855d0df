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
  return LogPlayer(config, log, options, estimator).Play();
}

RunResult RunEstimator(const EstimatorConfig& config, const MeasurementLog& log, const RunOptions& options) {
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
    RunResult result = RunEstimator(unwatched, log, options, filter.get());
    AttachAudit(audit.records(), &result);
    return result;
  }
  const std::unique_ptr<Estimator> estimator = MakeEstimator(config, log.rig);
  return RunEstimator(config, log, options, estimator.get());
}

RunResult RunEstimator(const EstimatorConfig& config, const MeasurementLog& log, const Trajectory* truth,
                       unsigned seed) {
  RunOptions options;
  options.truth = truth;
  options.seed = seed;
  return RunEstimator(config, log, options);
}

}  // namespace alidade
