#include <benchmark/benchmark.h>

#include "eval/config/config_yaml.h"
#include "eval/simulation/simulator_config.h"
#include "smoother/sliding/smoother.h"
#include "tests/support/scenario.h"
#include "tests/support/short_figure_eight.h"

namespace alidade {
namespace {

/// Defaults with what the named smoothers differ in, at most 8 solver iterations.
EstimatorConfig Smoother(SmootherLandmark landmark, RobustKernel kernel, ErrorConvention error,
                         int slam_features) {
  EstimatorConfig config;
  config.backend = Backend::kSmoother;
  config.vision.robust_kernel = kernel;
  config.smoother.error = error;
  config.smoother.landmark = landmark;
  config.smoother.max_iterations = 8;
  config.smoother.slam_features = slam_features;
  config.smoother.frames = slam_features > 0 ? FramePolicy::kEveryFrame : FramePolicy::kKeyframes;
  return config;
}

EstimatorConfig Shipped() {
  return *LoadEstimatorConfig(std::string(ALIDADE_SOURCE_DIR) + "/configs/estimators/alidade_smoother.yaml",
                              {});
}

/// One iteration is one camera frame of the figure-8 in the steady state: marginalisation or removal of a
/// frame, prediction, solve, gate, covariance. Arguments: window, tracks.
void SmootherFrame(benchmark::State& state, EstimatorConfig config) {
  SimulatorConfig sim = test::ShortFigureEight();
  sim.max_features = static_cast<int>(state.range(1));
  sim.landmark_count = std::max(sim.landmark_count, 6 * sim.max_features);
  const Dataset dataset = test::SimulateOrDie(sim, 1);
  config.smoother.window = static_cast<int>(state.range(0));
  config.smoother.max_landmarks = sim.max_features;
  const NavEstimate initial = test::DrawInitialState(dataset, 1);
  constexpr size_t kWarmUpFrames = 60;
  std::unique_ptr<Estimator> smoother;
  size_t frame = dataset.frames.size();
  size_t imu = 0;
  double tracks = 0;
  double used = 0;
  double rows = 0;
  double solver_iterations = 0;
  const auto feed_imu = [&] {
    while (imu == 0 || dataset.imu[imu - 1].stamp_ns < dataset.frames[frame].stamp_ns) {
      (void)smoother->AddImu(dataset.imu[imu++]);
    }
  };
  for ([[maybe_unused]] auto _ : state) {
    state.PauseTiming();
    if (frame == dataset.frames.size()) {
      smoother = MakeSmoother(config, dataset.rig);
      (void)smoother->Initialize(initial);
      imu = 0;
      for (frame = 0; frame < kWarmUpFrames; ++frame) {
        feed_imu();
        (void)smoother->AddFrame(dataset.frames[frame]);
      }
    }
    feed_imu();
    state.ResumeTiming();
    const Status status = smoother->AddFrame(dataset.frames[frame]);
    benchmark::DoNotOptimize(status.ok());
    tracks += smoother->last_statistics().tracks_in;
    used += smoother->last_statistics().features_used;
    rows += smoother->last_statistics().nis_dof;
    solver_iterations += smoother->last_statistics().iterations;
    ++frame;
  }
  state.counters["tracks"] = benchmark::Counter(tracks, benchmark::Counter::kAvgIterations);
  state.counters["used"] = benchmark::Counter(used, benchmark::Counter::kAvgIterations);
  state.counters["rows"] = benchmark::Counter(rows, benchmark::Counter::kAvgIterations);
  state.counters["solver"] = benchmark::Counter(solver_iterations, benchmark::Counter::kAvgIterations);
}

void Sizes(benchmark::internal::Benchmark* benchmark) {
  for (const int window : {5, 10, 20, 30}) {
    benchmark->Args({window, 150});
  }
  for (const int tracks : {50, 100, 200, 400}) {
    benchmark->Args({10, tracks});
  }
  benchmark->Unit(benchmark::kMillisecond);
}

/// What scripts/growth.sh needs besides Sizes.
void GrowthSizes(benchmark::internal::Benchmark* benchmark) {
  Sizes(benchmark);
  for (const int window : {35, 50}) {
    benchmark->Args({window, 150});
  }
  benchmark->Args({10, 800});
}

BENCHMARK_CAPTURE(SmootherFrame, pose_only,
                  Smoother(SmootherLandmark::kPoseOnly, RobustKernel::kHuber,
                           ErrorConvention::kRightInvariant, 0))
    ->Apply(Sizes);
BENCHMARK_CAPTURE(SmootherFrame, inverse_depth,
                  Smoother(SmootherLandmark::kInverseDepth, RobustKernel::kHuber,
                           ErrorConvention::kRightInvariant, 0))
    ->Apply(Sizes);
BENCHMARK_CAPTURE(SmootherFrame, alidade_smoother,
                  Smoother(SmootherLandmark::kPoseOnly, RobustKernel::kHuber,
                           ErrorConvention::kRightInvariant, 30))
    ->Apply(GrowthSizes);
// All of the preset: 80 landmarks in the prior, a watched calibration.
BENCHMARK_CAPTURE(SmootherFrame, shipped, Shipped())->Args({20, 150})->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(SmootherFrame, vins_mono_class,
                  Smoother(SmootherLandmark::kInverseDepth, RobustKernel::kCauchy, ErrorConvention::kSo3xRn,
                           0))
    ->Args({10, 150})
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace alidade
