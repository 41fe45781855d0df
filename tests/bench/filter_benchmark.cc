#include <benchmark/benchmark.h>

#include "eval/config/config_yaml.h"
#include "eval/simulation/simulator_config.h"
#include "filter/filter.h"
#include "tests/support/scenario.h"
#include "tests/support/short_figure_eight.h"

namespace alidade {
namespace {

/// Defaults with what the named updates differ in.
EstimatorConfig Immediate() {
  return EstimatorConfig();
}

EstimatorConfig DelayedMsckf() {
  EstimatorConfig config;
  config.filter.landmark = FilterLandmark::kMsckf;
  config.filter.update = UpdateTiming::kDelayedAll;
  config.filter.min_observations = 5;
  config.filter.clone_policy = ClonePolicy::kOldest;
  return config;
}

EstimatorConfig AlidadeFilter() {
  return *LoadEstimatorConfig(std::string(ALIDADE_SOURCE_DIR) + "/configs/estimators/alidade_filter.yaml",
                              {});
}

EstimatorConfig AlidadeFilterInSingle() {
  EstimatorConfig config = AlidadeFilter();
  config.filter.update_precision = UpdatePrecision::kSingle;
  return config;
}

/// One iteration is one camera frame of the figure-8 in the steady state: propagation over ten IMU samples,
/// cloning, update, marginalisation. Arguments: window, tracks.
void FilterFrame(benchmark::State& state, EstimatorConfig (*preset)()) {
  SimulatorConfig sim = test::ShortFigureEight();
  sim.max_features = static_cast<int>(state.range(1));
  sim.landmark_count = std::max(sim.landmark_count, 6 * sim.max_features);
  const Dataset dataset = test::SimulateOrDie(sim, 1);
  EstimatorConfig config = preset();
  config.filter.window = static_cast<int>(state.range(0));
  const NavEstimate initial = test::DrawInitialState(dataset, 1);
  constexpr size_t kWarmUpFrames = 60;
  std::unique_ptr<Estimator> filter;
  size_t frame = dataset.frames.size();
  size_t imu = 0;
  double tracks = 0;
  double used = 0;
  double rows = 0;
  const auto feed_imu = [&] {
    while (imu == 0 || dataset.imu[imu - 1].stamp_ns < dataset.frames[frame].stamp_ns) {
      (void)filter->AddImu(dataset.imu[imu++]);
    }
  };
  for ([[maybe_unused]] auto _ : state) {
    state.PauseTiming();
    if (frame == dataset.frames.size()) {
      filter = MakeFilter(config, dataset.rig);
      (void)filter->Initialize(initial);
      imu = 0;
      for (frame = 0; frame < kWarmUpFrames; ++frame) {
        feed_imu();
        (void)filter->AddFrame(dataset.frames[frame]);
      }
    }
    feed_imu();
    state.ResumeTiming();
    const Status status = filter->AddFrame(dataset.frames[frame]);
    benchmark::DoNotOptimize(status.ok());
    tracks += filter->last_statistics().tracks_in;
    used += filter->last_statistics().features_used;
    rows += filter->last_statistics().nis_dof;
    ++frame;
  }
  state.counters["tracks"] = benchmark::Counter(tracks, benchmark::Counter::kAvgIterations);
  state.counters["used"] = benchmark::Counter(used, benchmark::Counter::kAvgIterations);
  state.counters["rows"] = benchmark::Counter(rows, benchmark::Counter::kAvgIterations);
}

void Sizes(benchmark::internal::Benchmark* benchmark) {
  for (const int window : {5, 11, 25, 50}) {
    benchmark->Args({window, 150});
  }
  for (const int tracks : {50, 100, 200, 400}) {
    benchmark->Args({25, tracks});
  }
  benchmark->Unit(benchmark::kMillisecond);
}

/// What scripts/growth.sh needs besides Sizes.
void GrowthSizes(benchmark::internal::Benchmark* benchmark) {
  Sizes(benchmark);
  for (const int window : {10, 20, 35}) {
    benchmark->Args({window, 150});
  }
  benchmark->Args({25, 800});
}

BENCHMARK_CAPTURE(FilterFrame, alidade_filter, AlidadeFilter)->Apply(GrowthSizes);
BENCHMARK_CAPTURE(FilterFrame, alidade_filter_single, AlidadeFilterInSingle)
    ->Args({25, 150})
    ->Args({50, 150})
    ->Args({25, 400})
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(FilterFrame, po_multi_immediate, Immediate)->Apply(Sizes);
BENCHMARK_CAPTURE(FilterFrame, msckf_delayed, DelayedMsckf)->Args({25, 150})->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace alidade
