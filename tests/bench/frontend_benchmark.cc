#include <benchmark/benchmark.h>

#include <memory>
#include <utility>

#include "eval/frontend_run/frontend_summary.h"
#include "eval/frontend_run/image_pipeline.h"
#include "frontend/tracking/klt_tracker.h"
#include "tests/bench/image_sequences.h"

namespace alidade {
namespace {

constexpr std::size_t kWarmUpFrames = 10;

/// A front end on a sequence, image by image.
class Playback {
 public:
  Playback(const FrontendConfig& config, const test::ImageSequence& sequence)
      : tracker_(config, sequence.dataset.rig), sequence_(sequence) {}

  [[nodiscard]] bool AtEnd() const { return next_ == sequence_.images.size(); }
  /// The gyroscope up to the next image, and that image.
  Result<TrackFrame> Step() {
    const TimeNs stamp_ns = sequence_.stamps[next_];
    const std::vector<ImuSample>& imu = sequence_.dataset.imu;
    const TimeNs imu_ns = stamp_ns + SecondsToNs(sequence_.dataset.rig.camera_time_offset_s);
    while (next_imu_ < imu.size() && (next_imu_ == 0 || imu[next_imu_ - 1].stamp_ns < imu_ns)) {
      tracker_.AddImu(imu[next_imu_++]);
    }
    const GreyImage& image = sequence_.images[next_++];
    return tracker_.Track(stamp_ns, image.pixels.data(), image.width_px, image.height_px);
  }
  /// The first images, which are not timed.
  Status WarmUp() {
    for (std::size_t i = 0; i < kWarmUpFrames && !AtEnd(); ++i) {
      ALIDADE_RETURN_IF_ERROR(Step().status());
    }
    return AtEnd() ? Status::Input("no image after the warm-up") : Status::Ok();
  }

 private:
  KltTracker tracker_;
  const test::ImageSequence& sequence_;
  std::size_t next_ = 0;
  std::size_t next_imu_ = 0;
};

/// What the tracks of one pass are like.
Result<FrontendSummary> Summarize(const FrontendConfig& config, const test::ImageSequence& sequence) {
  std::vector<TrackerStatistics> statistics;
  PipelineOptions options;
  options.statistics = &statistics;
  const Result<std::vector<TrackFrame>> frames = TrackImages(
      sequence.dataset, sequence.stamps,
      [&](std::size_t frame) { return Result<GreyImage>(sequence.images[frame]); }, config, options);
  ALIDADE_RETURN_IF_ERROR(frames.status());
  return SummarizeFrontend(*frames, statistics);
}

/// One iteration is one image of 752 x 480 pixels, decoded before: gyroscope, pyramid, tracking, epipolar
/// rejection, detection, by the default front end with 150 features. The first images of each pass are not
/// timed. Counters: of a whole pass, equal for equal tracks.
void FrontendFrame(benchmark::State& state, const Result<test::ImageSequence>& sequence) {
  FrontendConfig config;
  config.max_features = 150;
  const Result<FrontendSummary> summary =
      sequence.ok() ? Summarize(config, *sequence) : Result<FrontendSummary>(sequence.status());
  if (!summary.ok()) {
    state.SkipWithError(summary.message().c_str());
    return;
  }
  std::unique_ptr<Playback> playback;
  for ([[maybe_unused]] auto _ : state) {
    state.PauseTiming();
    if (playback == nullptr || playback->AtEnd()) {
      playback = std::make_unique<Playback>(config, *sequence);
      if (const Status warmed = playback->WarmUp(); !warmed.ok()) {
        state.SkipWithError(warmed.message().c_str());
        break;
      }
    }
    state.ResumeTiming();
    const Result<TrackFrame> frame = playback->Step();
    if (!frame.ok()) {
      state.SkipWithError(frame.message().c_str());
      break;
    }
  }
  state.counters["features"] = summary->features_per_frame;
  state.counters["life"] = summary->mean_length;
  state.counters["lost_share"] = summary->lost_share;
  state.counters["rejected_share"] = summary->rejected_share;
}

/// Each sequence is rendered or read when its benchmark first runs.
void Rendered(benchmark::State& state) {
  static const Result<test::ImageSequence> kSequence = test::RenderedFigureEight();
  FrontendFrame(state, kSequence);
}

void RenderedV102(benchmark::State& state) {
  static const Result<test::ImageSequence> kSequence = test::RenderedV102();
  FrontendFrame(state, kSequence);
}

void RealFlight(benchmark::State& state) {
  static const Result<test::ImageSequence> kSequence = test::RealFlight();
  FrontendFrame(state, kSequence);
}

BENCHMARK(Rendered)->Name("FrontendFrame/rendered_figure8")->Unit(benchmark::kMillisecond);
BENCHMARK(RenderedV102)->Name("FrontendFrame/rendered_v1_02")->Unit(benchmark::kMillisecond);
BENCHMARK(RealFlight)->Name("FrontendFrame/flight_v1_01")->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace alidade
