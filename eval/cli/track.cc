#include <algorithm>
#include <cstdio>

#include "eval/bag/dataset_images.h"
#include "eval/cli/commands.h"
#include "eval/cli/exit_code.h"
#include "eval/cli/flags.h"
#include "eval/cli/score.h"
#include "eval/cli/support.h"
#include "eval/dataset/dataset_tracks.h"
#include "eval/dataset/dataset_writer.h"
#include "eval/dataset/digest.h"
#include "eval/files/output_file.h"
#include "eval/frontend_run/frontend_summary.h"
#include "eval/frontend_run/image_pipeline.h"
#include "eval/frontend_run/track_overlay.h"

namespace alidade::cli {
namespace {

/// Pictures of every FLAGS_overlay-th image with its tracks.
Status DrawOverlays(const Dataset& dataset, const std::vector<TrackFrame>& frames) {
  const auto step = static_cast<size_t>(FLAGS_overlay);
  DatasetImages images;
  for (size_t i = 0; step > 0 && i < frames.size(); i += step) {
    const auto entry = std::find_if(
        dataset.images.begin(), dataset.images.end(),
        [&frames, i](const ImageEntry& candidate) { return candidate.stamp_ns == frames[i].stamp_ns; });
    if (entry == dataset.images.end()) {
      continue;
    }
    const Result<GreyImage> image = images.Read(*entry);
    ALIDADE_RETURN_IF_ERROR(image.status());
    ALIDADE_RETURN_IF_ERROR(WriteTrackOverlay(
        *image, frames, i, FLAGS_output + "/overlay/" + std::to_string(frames[i].stamp_ns) + ".png"));
  }
  return Status::Ok();
}

/// What `track` leaves: the sequence with its tracks, a row an image of what the front end did, and pictures.
Status WriteAll(const Dataset& dataset, const std::vector<TrackerStatistics>& statistics) {
  ALIDADE_RETURN_IF_ERROR(WriteDataset(dataset, FLAGS_output));
  ALIDADE_RETURN_IF_ERROR(
      WriteFileAtomically(FLAGS_output + "/frontend.csv", FrontendCsv(dataset.frames, statistics)));
  return DrawOverlays(dataset, dataset.frames);
}

/// Tracks that exist: those of --tracks, or of a sequence without images; none: the front end makes them.
Result<std::vector<TrackFrame>> GivenTracks(const Dataset& dataset) {
  if (!FLAGS_tracks.empty()) {
    return FLAGS_score
               ? ReadTracks(FLAGS_tracks)
               : Status::Usage("track: --tracks is for --score, the front end makes tracks of images");
  }
  return FLAGS_score && dataset.images.empty() ? dataset.frames : std::vector<TrackFrame>();
}

/// Runs the front end over the images, writes what it leaves, and scores it if asked to.
int TrackAndWrite(const FrontendConfig& config, Dataset* dataset) {
  std::vector<TrackerStatistics> statistics;
  std::vector<double> cpu_ms;
  PipelineOptions options;
  options.statistics = &statistics;
  options.cpu_ms = &cpu_ms;
  options.stop = InstallInterruptHandler();
  options.remark = PrintNote;
  ProgressLine progress("images");
  options.progress = [&progress](size_t done, size_t total) { progress.Update(done, total); };
  Result<std::vector<TrackFrame>> frames = TrackImages(*dataset, config, options);
  if (options.stop->load()) {
    return kExitInterrupted;
  }
  if (!frames.ok()) {
    return Report(frames.status());
  }
  dataset->frames = std::move(*frames);
  const MeasurementLog log{dataset->rig, dataset->imu, dataset->frames, dataset->extra_cameras};
  if (const Status status = WriteAll(*dataset, statistics); !status.ok()) {
    return Report(status);
  }
  const FrontendSummary summary = SummarizeFrontend(dataset->frames, statistics);
  std::printf("%s\n", DescribeLog(log, DigestOf(log)).c_str());
  std::printf(
      "%.2f ms an image (95 %%: %.2f), %.1f features, tracks of %.1f frames; %.2f %% lost, %.2f %% "
      "rejected by the epipolar geometry a frame\n",
      summary.mean_ms, summary.p95_ms, summary.features_per_frame, summary.mean_length,
      100 * summary.lost_share, 100 * summary.rejected_share);
  return FLAGS_score ? Report(ReportTrackScore(*dataset, dataset->frames, cpu_ms)) : kExitDone;
}

}  // namespace

int RunTrack(const std::vector<std::string>&) {
  const Result<EstimatorConfig> config = EstimatorConfigFromFlags();
  if (!config.ok()) {
    return Report(config.status());
  }
  if (FLAGS_overlay < 0) {
    return Report(
        Status::Config("--overlay: found " + std::to_string(FLAGS_overlay) + ", expected 0 or more"));
  }
  if (const Status status = CheckOutputFolder(FLAGS_output, FLAGS_overwrite); !status.ok()) {
    return Report(status);
  }
  Result<Dataset> dataset = ReadDatasetFromFlags();
  if (!dataset.ok()) {
    return Report(dataset.status());
  }
  const Result<std::vector<TrackFrame>> given = GivenTracks(*dataset);
  if (!given.ok()) {
    return Report(given.status());
  }
  if (const Status status = PrepareOutputFolder(FLAGS_output, FLAGS_overwrite); !status.ok()) {
    return Report(status);
  }
  return given->empty() ? TrackAndWrite(config->frontend, &*dataset)
                        : Report(ReportTrackScore(*dataset, *given, {}));
}

}  // namespace alidade::cli
