#include <benchmark/benchmark.h>

#include <algorithm>
#include <memory>
#include <string>

#include "eval/config/config_yaml.h"
#include "eval/simulation/simulator.h"
#include "eval/simulation/simulator_config.h"
#include "tests/bench/recorded_calls.h"

namespace alidade {
namespace {

/// A shipped estimator on 40 s of the figure-8 outdoors, frames and epochs at 10 Hz.
Result<test::RecordedCalls> Record(const std::string& estimator) {
  const std::string configs = std::string(ALIDADE_SOURCE_DIR) + "/configs/";
  const Result<EstimatorConfig> config =
      LoadEstimatorConfig(configs + "estimators/" + estimator + ".yaml", {});
  ALIDADE_RETURN_IF_ERROR(config.status());
  const Result<SimulatorConfig> simulation =
      LoadSimulatorConfig(configs + "datasets/gnss_figure8.yaml", {"duration_s=40", "path_m=167"});
  ALIDADE_RETURN_IF_ERROR(simulation.status());
  Result<Dataset> dataset = Simulate(*simulation, 1);
  ALIDADE_RETURN_IF_ERROR(dataset.status());
  constexpr int kWarmUpFrames = 60;
  return test::RecordCalls(*config, *std::move(dataset), kWarmUpFrames);
}

/// Makes the calls before the next iteration; past the last one a new run begins.
void MoveToNext(const test::RecordedCalls& recorded, bool with_frame, std::unique_ptr<test::Replay>* replay) {
  const auto is_next = [&] {
    return with_frame ? (*replay)->NextIs<TrackFrame>() : (*replay)->NextIs<GnssEpoch>();
  };
  for (;;) {
    if (*replay == nullptr || (*replay)->AtEnd()) {
      *replay = std::make_unique<test::Replay>(recorded);
    }
    if (is_next()) {
      return;
    }
    (*replay)->Step();
  }
}

/// One iteration is one epoch of the steady state: with `with_frame` the frame before it and the IMU samples
/// between them too, as a smoother solves for an epoch in the next frame; else the epoch alone, propagation
/// to it included.
void GnssStep(benchmark::State& state, const char* estimator, bool with_frame) {
  const Result<test::RecordedCalls> recorded = Record(estimator);
  if (!recorded.ok()) {
    state.SkipWithError(recorded.message().c_str());
    return;
  }
  std::unique_ptr<test::Replay> replay;
  double rows = 0;
  for ([[maybe_unused]] auto _ : state) {
    state.PauseTiming();
    MoveToNext(*recorded, with_frame, &replay);
    state.ResumeTiming();
    int step_rows = 0;
    for (bool last = false; !last;) {
      last = replay->NextIs<GnssEpoch>();
      replay->Step();
      step_rows = std::max(step_rows, replay->statistics().gnss_nis_dof);
    }
    rows += step_rows;
    if (!replay->status().ok()) {
      state.SkipWithError(replay->status().message().c_str());
      break;
    }
  }
  state.counters["rows"] = benchmark::Counter(rows, benchmark::Counter::kAvgIterations);
}

BENCHMARK_CAPTURE(GnssStep, gvio, "gvio", false)->Name("GnssEpoch/gvio")->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(GnssStep, gvio_frame, "gvio", true)
    ->Name("GnssFrameAndEpoch/gvio")
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(GnssStep, gvins_class_frame, "gvins_class", true)
    ->Name("GnssFrameAndEpoch/gvins_class")
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace alidade
