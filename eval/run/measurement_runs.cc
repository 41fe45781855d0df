#include "eval/run/measurement_runs.h"

#include "eval/run/fix_run.h"

namespace alidade {

std::vector<std::unique_ptr<MeasurementRun>> MakeMeasurementRuns(const EstimatorConfig& config,
                                                                 const RigCalibration& rig,
                                                                 const SessionOptions& options,
                                                                 bool with_gnss, Estimator* estimator,
                                                                 std::vector<SessionEvent>* events) {
  std::vector<std::unique_ptr<MeasurementRun>> runs;
  if (config.fix.enabled && !rig.fixes.empty()) {
    runs.push_back(
        std::make_unique<FixRun>(config, rig, options.lateness.fix_s, with_gnss, estimator, events));
  }
  return runs;
}

}  // namespace alidade
