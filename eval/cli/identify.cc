#include <cstdio>

#include "eval/bag/dataset_source.h"
#include "eval/cli/commands.h"
#include "eval/cli/exit_code.h"
#include "eval/cli/flags.h"
#include "eval/cli/support.h"
#include "eval/dataset/dataset.h"
#include "eval/dataset/dataset_imu.h"
#include "eval/frontend_run/image_pipeline.h"
#include "eval/identify/motion_report.h"
#include "eval/identify/rest_report.h"

namespace alidade::cli {
namespace {

/// Of a folder the IMU alone: a recording at rest often has no other sensor.
Result<Dataset> ReadImuFromFlags() {
  if (!FormatOf(FLAGS_dataset).is_asl || !FLAGS_topics.empty() || !FLAGS_calibration.empty()) {
    return ReadDatasetFromFlags();
  }
  Dataset dataset;
  ALIDADE_RETURN_IF_ERROR(ReadImuFolder(FLAGS_dataset + "/mav0", {}, &dataset));
  return dataset;
}

int IdentifyRest(const EstimatorConfig& config) {
  const Result<Dataset> dataset = ReadImuFromFlags();
  if (!dataset.ok()) {
    return Report(dataset.status());
  }
  const Result<RestNoise> noise = IdentifyAtRest(dataset->imu, config.init);
  if (!noise.ok()) {
    return Report(noise.status());
  }
  std::fputs(RestNoiseTable(*noise).c_str(), stdout);
  return Report(WriteRestNoise(*noise, FLAGS_dataset, FLAGS_output));
}

int IdentifyMotion(const EstimatorConfig& config) {
  const Result<Dataset> dataset = ReadDatasetFromFlags();
  if (!dataset.ok()) {
    return Report(dataset.status());
  }
  const std::atomic<bool>* stop = InstallInterruptHandler();
  const Result<MeasurementLog> log = MakeLog(*dataset, config.frontend, {stop, {}});
  if (!log.ok()) {
    return stop->load() ? kExitInterrupted : Report(log.status());
  }
  MotionOptions options;
  options.run.truth = dataset->truth ? &*dataset->truth : nullptr;
  options.run.seed = FLAGS_seed;
  options.run.stop = stop;
  options.jobs = FLAGS_jobs;
  options.progress = PrintNote;
  const Result<MotionNoise> noise = IdentifyInMotion(config, *log, options);
  if (!noise.ok()) {
    return stop->load() ? kExitInterrupted : Report(noise.status());
  }
  std::fputs(MotionNoiseTable(*noise).c_str(), stdout);
  return Report(WriteMotionNoise(*noise, FLAGS_dataset, dataset->imu_rate_hz, FLAGS_output));
}

}  // namespace

int RunIdentify(const std::vector<std::string>&) {
  const Result<EstimatorConfig> config = EstimatorConfigFromFlags();
  if (!config.ok()) {
    return Report(config.status());
  }
  if (const Status status = RequireOutputBesideDataset(FLAGS_output, FLAGS_dataset); !status.ok()) {
    return Report(status);
  }
  if (const Status status = PrepareOutputFolder(FLAGS_output, FLAGS_overwrite); !status.ok()) {
    return Report(status);
  }
  return FLAGS_motion ? IdentifyMotion(*config) : IdentifyRest(*config);
}

}  // namespace alidade::cli
