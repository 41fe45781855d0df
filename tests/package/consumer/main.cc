#include <cstdio>
#include <string>

#include "eval/config/config_yaml.h"
#include "eval/metrics/evaluate.h"
#include "eval/record/run_options.h"
#include "eval/record/runner.h"
#include "eval/simulation/simulator.h"
#include "eval/simulation/simulator_config.h"
#include "filter/filter_estimator.h"

// Runs the filter of one shipped preset on a short simulated flight and prints its error.

namespace {

alidade::Result<alidade::Evaluation> RunFilter(const std::string& configs) {
  const alidade::Result<alidade::SimulatorConfig> world =
      alidade::LoadSimulatorConfig(configs + "/datasets/figure8_short.yaml", {"duration_s=10", "path_m=13"});
  ALIDADE_RETURN_IF_ERROR(world.status());
  const alidade::Result<alidade::Dataset> dataset = alidade::Simulate(*world, 1);
  ALIDADE_RETURN_IF_ERROR(dataset.status());
  const alidade::Result<alidade::EstimatorConfig> config =
      alidade::LoadEstimatorConfig(configs + "/estimators/alidade_filter.yaml", {"init.method=truth"});
  ALIDADE_RETURN_IF_ERROR(config.status());

  const alidade::MeasurementLog log{dataset->rig, dataset->imu, dataset->frames};
  alidade::RunOptions options;
  options.truth = &*dataset->truth;
  alidade::FilterEstimator filter(*config, log.rig);
  const alidade::RunResult run = alidade::RunEstimator(*config, log, options, &filter);
  ALIDADE_RETURN_IF_ERROR(run.status);
  return alidade::Evaluate(*dataset->truth, alidade::TrajectoryOf(run), alidade::EvaluationOptions());
}

}  // namespace

int main() {
  const alidade::Result<alidade::Evaluation> evaluation = RunFilter(ALIDADE_CONFIGS_DIR);
  if (!evaluation.ok()) {
    std::fprintf(stderr, "%s\n", evaluation.message().c_str());
    return 1;
  }
  std::printf("%zu states over %.1f m, RMSE %.3f m\n", evaluation->pairs.size(), evaluation->path_m,
              evaluation->unaligned.pos_m);
  return 0;
}
