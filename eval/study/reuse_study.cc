#include "eval/study/reuse_study.h"

#include "eval/audit/covariance_analysis.h"
#include "eval/dataset/dataset.h"
#include "eval/record/run_options.h"
#include "eval/record/runner.h"
#include "eval/simulation/simulator.h"
#include "filter/filter.h"

namespace alidade {
namespace {

void Immediate(BaseReuse reuse, FilterConfig* filter) {
  filter->update = UpdateTiming::kImmediate;
  filter->base_reuse = reuse;
}

/// The filter with the noise that it assumes, the world without any.
EstimatorConfig WithAssumedNoise(const EstimatorConfig& estimator, const SimulatorConfig& simulation) {
  EstimatorConfig config = estimator;
  config.backend = Backend::kFilter;
  config.vision.pixel_noise_px = simulation.pixel_noise_px;
  config.vision.gate_probability = 1;
  config.vision.robust_kernel = RobustKernel::kNone;
  config.vision.rest_updates = false;
  config.filter.track_memory = TrackMemoryPolicy::kNone;  // its rows are not traced to observations
  config.init.method = InitMethod::kTruth;
  config.init.perturb_truth = false;
  return config;
}

}  // namespace

const std::vector<ReusePolicy>& ReusePolicies() {
  static const std::vector<ReusePolicy> policies = {
      {"joint", "all observations of a track at once",
       [](FilterConfig* filter) { filter->update = UpdateTiming::kDelayedAll; }},
      {"disjoint", "immediate, a new base each round",
       [](FilterConfig* filter) { Immediate(BaseReuse::kDisjoint, filter); }},
      {"reuse", "immediate, base re-used with its plain noise (the paper)",
       [](FilterConfig* filter) { Immediate(BaseReuse::kPaper, filter); }},
      {"inflate", "immediate, re-used base with twice its deviation",
       [](FilterConfig* filter) {
         Immediate(BaseReuse::kInflate, filter);
         filter->base_inflation = 2;
       }},
      {"limit", "immediate, at most two rounds a base",
       [](FilterConfig* filter) {
         Immediate(BaseReuse::kLimit, filter);
         filter->max_base_rounds = 2;
       }},
  };
  return policies;
}

Result<ReusePrediction> PredictConsistency(const SimulatorConfig& simulation,
                                           const EstimatorConfig& estimator, const ReusePolicy& policy,
                                           int window, unsigned seed) {
  if (simulation.IsHybrid()) {
    return Status::Config("hybrid_dataset: the analysis needs a noise-free IMU; expected a simulated one");
  }
  EstimatorConfig config = WithAssumedNoise(estimator, simulation);
  config.filter.window = window;
  policy.apply(&config.filter);
  ALIDADE_RETURN_IF_ERROR(config.Validate());
  SimulatorConfig quiet = simulation;
  quiet.pixel_noise_px = 0;
  quiet.outlier_rate = 0;
  quiet.imu_noise = {0, 0, 0, 0};
  quiet.gyro_scale_std = quiet.accel_scale_std = quiet.misalignment_std_rad = 0;
  const Result<Dataset> dataset = Simulate(quiet, seed);
  if (!dataset.ok()) {
    return dataset.status();
  }
  MeasurementLog log{dataset->rig, dataset->imu, dataset->frames};
  log.rig.imu_noise = simulation.imu_noise;
  CovarianceAnalysis analysis;
  const std::unique_ptr<Estimator> filter = MakeFilter(config, log.rig, &analysis);
  RunOptions options;
  options.truth = dataset->truth ? &*dataset->truth : nullptr;
  const RunResult run = RunEstimator(config, log, options, filter.get());
  ALIDADE_RETURN_IF_ERROR(run.status);
  if (analysis.unmodelled_reuse() > 0) {
    return Status::Config(
        "filter.update: an observation other than a base was used twice; the analysis supports "
        "the timings immediate, at_l and delayed_all");
  }
  if (analysis.met_landmark()) {
    return Status::Config(
        "filter: a landmark entered the state; the analysis supports only filters without SLAM features");
  }
  ReusePrediction mean;
  const std::vector<CovarianceRecord>& records = analysis.records();
  const size_t first = records.size() / 2;
  const double share = 1.0 / static_cast<double>(std::max<size_t>(records.size() - first, 1));
  for (size_t i = first; i < records.size(); ++i) {
    mean.nees_ratio += share * records[i].nees_ratio;
    mean.position_m += share * records[i].position_m;
    mean.orientation_rad += share * records[i].orientation_rad;
  }
  return mean;
}

}  // namespace alidade
