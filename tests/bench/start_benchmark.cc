#include <benchmark/benchmark.h>

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "eval/simulation/simulator.h"
#include "eval/simulation/simulator_config.h"
#include "frontend/initialization/initializer.h"

namespace alidade {
namespace {

/// EuRoC's rates, 150 tracks at 1 px.
SimulatorConfig Motion() {
  SimulatorConfig config;
  config.duration_s = 20;
  config.path_m = 26;
  config.imu_rate_hz = 200;
  config.camera_rate_hz = 20;
  return config;
}

/// An initializer that is given a sequence frame by frame, from the frame `first` on.
class Search {
 public:
  Search(InitMethod method, const Dataset& dataset, std::size_t first)
      : dataset_(dataset), initializer_(ConfigOf(method), dataset.rig), frame_(first) {
    const auto begin =
        std::lower_bound(dataset.imu.begin(), dataset.imu.end(), dataset.frames[first].stamp_ns,
                         [](const ImuSample& sample, TimeNs stamp_ns) { return sample.stamp_ns < stamp_ns; });
    imu_ = static_cast<std::size_t>(begin - dataset.imu.begin());
    imu_ -= imu_ > 0 ? 1 : 0;
  }

  [[nodiscard]] bool AtEnd() const { return frame_ == dataset_.frames.size(); }
  [[nodiscard]] std::size_t frame() const { return frame_; }  ///< the next one
  /// Samples up to the first one at or after the next frame.
  void AddImu() {
    for (bool reached = false; !reached && imu_ < dataset_.imu.size(); ++imu_) {
      initializer_.AddImu(dataset_.imu[imu_]);
      reached = dataset_.imu[imu_].stamp_ns >= dataset_.frames[frame_].stamp_ns;
    }
  }
  Result<NavEstimate> AddFrame() { return initializer_.AddFrame(dataset_.frames[frame_++]); }
  /// Frames before the frame `end`.
  void AdvanceTo(std::size_t end) {
    while (frame_ < end) {
      AddImu();
      benchmark::DoNotOptimize(AddFrame());
    }
  }

 private:
  static EstimatorConfig ConfigOf(InitMethod method) {
    EstimatorConfig config;
    config.init.method = method;
    return config;
  }

  const Dataset& dataset_;
  Initializer initializer_;
  std::size_t frame_;
  std::size_t imu_ = 0;
};

/// A sequence and where a search in it succeeds.
struct Start {
  Dataset dataset;
  std::size_t first = 0;  ///< frame of the search
  std::size_t found = 0;  ///< frame with which it succeeds
};

Result<Start> FindStart(InitMethod method, const SimulatorConfig& config, std::size_t first) {
  Result<Dataset> dataset = Simulate(config, 500);
  ALIDADE_RETURN_IF_ERROR(dataset.status());
  Start start{*std::move(dataset), first, 0};
  Search search(method, start.dataset, first);
  Status refusal = Status::Diverged("no frame");
  while (!search.AtEnd()) {
    search.AddImu();
    const Result<NavEstimate> found = search.AddFrame();
    if (found.ok()) {
      start.found = search.frame() - 1;
      return start;
    }
    refusal = found.status();
  }
  return refusal;
}

void SetDataCounter(const Start& start, benchmark::State* state) {
  const std::vector<TrackFrame>& frames = start.dataset.frames;
  state->counters["data_s"] = SecondsBetween(frames[start.first].stamp_ns, frames[start.found].stamp_ns);
}

/// One iteration is an attempt at rest that succeeds: every frame makes one.
void StartAttemptStatic(benchmark::State& state) {
  SimulatorConfig config = Motion();
  config.rest_s = 15;
  const Result<Start> start = FindStart(InitMethod::kStatic, config, 0);
  if (!start.ok()) {
    state.SkipWithError(start.message().c_str());
    return;
  }
  constexpr std::size_t kInMotion = 280;  // before the frame that sees the motion begin
  if (start->found >= kInMotion) {
    state.SkipWithError("the start was not found at rest");
    return;
  }
  std::unique_ptr<Search> search;
  for ([[maybe_unused]] auto _ : state) {
    state.PauseTiming();
    if (search == nullptr || search->frame() >= kInMotion) {
      search = std::make_unique<Search>(InitMethod::kStatic, start->dataset, start->first);
      search->AdvanceTo(start->found);
    }
    search->AddImu();
    state.ResumeTiming();
    const Result<NavEstimate> found = search->AddFrame();
    if (!found.ok()) {
      state.SkipWithError(found.message().c_str());
      break;
    }
  }
  SetDataCounter(*start, &state);
}

/// A search in motion, 150 tracks. One iteration is the attempt that succeeds (gyroscope bias, closed form,
/// refinement, checks) or, with `whole`, all frames up to it, refused attempts included.
void StartDynamic(benchmark::State& state, bool whole) {
  const Result<Start> start = FindStart(InitMethod::kDynamic, Motion(), 40);
  if (!start.ok()) {
    state.SkipWithError(start.message().c_str());
    return;
  }
  for ([[maybe_unused]] auto _ : state) {
    state.PauseTiming();
    Search search(InitMethod::kDynamic, start->dataset, start->first);
    search.AdvanceTo(whole ? start->first : start->found);
    search.AddImu();
    state.ResumeTiming();
    benchmark::DoNotOptimize(search.AddFrame());
    search.AdvanceTo(start->found + 1);  // nothing after the attempt that succeeds
  }
  SetDataCounter(*start, &state);
}

BENCHMARK(StartAttemptStatic)->Name("StartAttempt/static")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(StartDynamic, attempt, false)->Name("StartAttempt/dynamic")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(StartDynamic, search, true)->Name("StartSearch/dynamic")->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace alidade
