#include <cstdio>
#include <filesystem>

#include "eval/bag/dataset_source.h"
#include "eval/calibrate/camera_calibration.h"
#include "eval/calibrate/camera_report.h"
#include "eval/calibrate/provisional_sheets.h"
#include "eval/cli/commands.h"
#include "eval/cli/exit_code.h"
#include "eval/cli/flags.h"
#include "eval/cli/shipped_configs.h"
#include "eval/cli/support.h"
#include "eval/dataset/dataset_writer.h"
#include "eval/frontend_run/image_pipeline.h"

namespace alidade::cli {
namespace {

/// Where a sequence with provisional sheets stands while it is read.
std::string StagingFolder() {
  return FLAGS_output + "/provisional";
}

/// The log of a sequence whose sheets may be missing, with the tracks of its images.
struct RecordingToCalibrate {
  Dataset dataset;
  MeasurementLog log;
  bool guessed = false;  ///< its camera is a guess
};

Result<RecordingToCalibrate> ReadRecording(const FrontendConfig& frontend, const std::atomic<bool>* stop) {
  DatasetSource source = SourceFromFlags();
  ProvisionalSequence sequence;
  if (FormatOf(source.path).is_asl) {
    Result<ProvisionalSequence> completed = CompleteSheets(source.path, StagingFolder(), source.follow_links);
    ALIDADE_RETURN_IF_ERROR(completed.status());
    sequence = *std::move(completed);
    source.path = sequence.path;
  }
  Result<Dataset> dataset = ReadDataset(source);
  ALIDADE_RETURN_IF_ERROR(dataset.status());
  for (const std::string& remark : dataset->remarks) {
    PrintNote(remark);
  }
  if (sequence.imu_noise) {
    PrintNote(
        "imu0/sensor.yaml is missing: noise of a consumer IMU is assumed; `alidade identify` finds that of "
        "this one");
  }
  ProgressLine progress("images");
  PipelineOptions options;
  options.stop = stop;
  options.progress = [&progress](size_t done, size_t total) { progress.Update(done, total); };
  options.remark = PrintNote;
  Result<MeasurementLog> log = MakeLog(*dataset, frontend, options);
  dataset->path = FLAGS_dataset;  // what is staged will be gone
  ALIDADE_RETURN_IF_ERROR(log.status());
  return RecordingToCalibrate{*std::move(dataset), *std::move(log), sequence.camera};
}

/// The sequence with the found camera and the tracks, which can be run as it is.
Status WriteCalibrated(const CalibratedCamera& camera, RecordingToCalibrate recording) {
  const RigCalibration given = recording.dataset.rig;
  recording.dataset.frames = std::move(recording.log.frames);
  recording.dataset.rig = camera.rig;
  ALIDADE_RETURN_IF_ERROR(WriteDataset(recording.dataset, FLAGS_output));
  return WriteCalibratedCamera(camera, given, FLAGS_dataset, recording.dataset.camera_rate_hz, FLAGS_output);
}

}  // namespace

int RunCalibrate(const std::vector<std::string>&) {
  if (FLAGS_config.empty()) {
    const Result<std::string> shipped = LocateConfig(ConfigKind::kEstimator, "alidade_filter");
    if (!shipped.ok()) {
      return Report(shipped.status());
    }
    FLAGS_config = *shipped;
  }
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
  const std::atomic<bool>* stop = InstallInterruptHandler();
  Result<RecordingToCalibrate> recording = ReadRecording(config->frontend, stop);
  std::error_code ignored;
  std::filesystem::remove_all(StagingFolder(), ignored);
  if (!recording.ok()) {
    return stop->load() ? kExitInterrupted : Report(recording.status());
  }
  CameraCalibrationOptions options;
  options.run.stop = stop;
  options.run.seed = FLAGS_seed;
  options.progress = PrintNote;
  if (recording->guessed) {
    options.focal_factors = {0.7, 1, 1.4};
  }
  const Result<CalibratedCamera> camera = CalibrateCamera(*config, recording->log, options);
  if (!camera.ok()) {
    return stop->load() ? kExitInterrupted : Report(camera.status());
  }
  std::fputs(CalibratedCameraTable(*camera, recording->log.rig, recording->dataset.camera_rate_hz).c_str(),
             stdout);
  return Report(WriteCalibrated(*camera, *std::move(recording)));
}

}  // namespace alidade::cli
