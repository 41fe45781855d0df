#include <cstdio>

#include "eval/cli/command.h"
#include "eval/cli/command_line.h"
#include "eval/cli/flags.h"
#include "eval/cli/support.h"
#include "eval/config_yaml.h"
#include "eval/image_pipeline.h"

namespace alidade::cli {
namespace {

Result<EstimatorConfig> FrontendSettings() {
  if (!FLAGS_config.empty()) {
    return LoadEstimatorConfig(FLAGS_config, SplitSettings(FLAGS_set));
  }
  EstimatorConfig config;
  ALIDADE_RETURN_IF_ERROR(ApplySettings(SplitSettings(FLAGS_set),
                                        [&config](ConfigVisitor& visitor) { config.Describe(visitor); }));
  return config;
}

}  // namespace

int RunTrack(const std::vector<std::string>&) {
  const Result<EstimatorConfig> config = FrontendSettings();
  if (!config.ok()) {
    return Report(config.status());
  }
  Result<Dataset> dataset = ReadDataset(FLAGS_dataset);
  if (!dataset.ok()) {
    return Report(dataset.status());
  }
  if (const Status status = PrepareOutputFolder(FLAGS_output, FLAGS_overwrite); !status.ok()) {
    return Report(status);
  }
  PipelineOptions options;
  options.stop = InstallInterruptHandler();
  ProgressLine progress("images");
  options.progress = [&progress](size_t done, size_t total) { progress.Update(done, total); };
  Result<std::vector<TrackFrame>> frames = TrackImages(*dataset, config->frontend, options);
  if (options.stop->load()) {
    return kExitInterrupted;
  }
  if (!frames.ok()) {
    return Report(frames.status());
  }
  dataset->tracks = std::move(*frames);
  const MeasurementLog log{dataset->rig, dataset->imu, dataset->tracks, dataset->extra_cameras};
  if (const Status status = WriteDataset(*dataset, FLAGS_output); !status.ok()) {
    return Report(status);
  }
  std::printf("%s\n", DescribeLog(log, DigestOf(log)).c_str());
  return kExitDone;
}

}  // namespace alidade::cli
