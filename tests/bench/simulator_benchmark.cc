#include <benchmark/benchmark.h>

#include "eval/simulation/simulator.h"
#include "eval/simulation/simulator_config.h"

namespace alidade {
namespace {

/// One iteration is the whole default sequence: 200 s of IMU at 100 Hz, tracks at 10 Hz.
void SimulateSequence(benchmark::State& state) {
  unsigned seed = 0;
  for ([[maybe_unused]] auto _ : state) {
    const Result<Dataset> dataset = Simulate(SimulatorConfig(), ++seed);
    if (!dataset.ok()) {
      state.SkipWithError(dataset.message().c_str());
      return;
    }
    benchmark::DoNotOptimize(dataset->frames.size());
  }
}
BENCHMARK(SimulateSequence)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace alidade
