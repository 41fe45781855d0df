#include "eval/run/runner.h"

#include "eval/run/estimator_run.h"
#include "filter/filter.h"
#include "smoother/sliding/smoother.h"

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

std::string_view ToString(Backend backend) {
  switch (backend) {
    case Backend::kFilter:
      return "filter";
    case Backend::kSmoother:
      return "smoother";
    case Backend::kBatch:
      break;
  }
  return "batch";
}

std::unique_ptr<Estimator> MakeEstimator(const EstimatorConfig& config, const RigCalibration& rig) {
  switch (config.backend) {
    case Backend::kFilter:
      return MakeFilter(config, rig);
    case Backend::kSmoother:
      return MakeSmoother(config, rig);
    case Backend::kBatch:
      break;
  }
  return MakeBatch(
      config, rig,
      config.batch.initial == BatchInitial::kFilter ? MakeFilter(config, rig) : MakeSmoother(config, rig));
}

RunResult RunEstimator(const EstimatorConfig& config, const MeasurementLog& log, const RunOptions& options,
                       Estimator* estimator) {
  return EstimatorRun(config, log, options, estimator).Execute();
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
    const std::unique_ptr<Estimator> filter = MakeFilter(config, log.rig, &audit);
    RunResult result = RunEstimator(config, log, options, filter.get());
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
