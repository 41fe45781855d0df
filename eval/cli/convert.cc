#include <filesystem>

#include "core/format.h"
#include "eval/bag/bag_export.h"
#include "eval/bag/bag_folder.h"
#include "eval/bag/bag_parts.h"
#include "eval/cli/commands.h"
#include "eval/cli/exit_code.h"
#include "eval/cli/flags.h"
#include "eval/cli/split_words.h"
#include "eval/cli/support.h"
#include "eval/dataset/calibration_import.h"
#include "eval/dataset/dataset_reader.h"
#include "eval/files/output_file.h"

namespace alidade::cli {
namespace {

int FolderToBag(BagCompression compression) {
  if (const Status status = CheckOutputFile(FLAGS_output); !status.ok()) {
    return Report(status);
  }
  const Result<Dataset> dataset = ReadDataset(FLAGS_dataset, {.follow_links = FLAGS_follow_links});
  if (!dataset.ok()) {
    return Report(dataset.status());
  }
  for (const std::string& remark : dataset->remarks) {
    PrintNote(remark);
  }
  BagExportOptions options{FLAGS_topics, compression, InstallInterruptHandler(), {}};
  ProgressLine progress("messages");
  options.progress = [&progress](size_t done, size_t total) { progress.Update(done, total); };
  const Status written = WriteBag(*dataset, options, FLAGS_output);
  return options.stop->load() ? kExitInterrupted : Report(written);
}

int BagToFolder(const ImportedCalibration& calibration) {
  if (const Status status = PrepareOutputFolder(FLAGS_output, FLAGS_overwrite); !status.ok()) {
    return Report(status);
  }
  BagImportOptions options;
  options.topics = FLAGS_topics;
  options.imu = calibration.imu;
  options.imu_is_per_sample = calibration.imu_is_per_sample;
  options.camera = calibration.camera;
  options.stop = InstallInterruptHandler();
  ProgressLine progress("messages");
  options.progress = [&progress](std::int64_t done, std::int64_t total) {
    progress.Update(static_cast<size_t>(done), static_cast<size_t>(total));
  };
  const Result<std::vector<std::string>> remarks = ConvertBagToFolder(FLAGS_dataset, options, FLAGS_output);
  if (options.stop->load()) {
    return kExitInterrupted;
  }
  if (!remarks.ok()) {
    return Report(remarks.status());
  }
  for (const std::string& remark : *remarks) {
    PrintNote(remark);
  }
  return kExitDone;
}

/// The sensor sheets alone, for a folder that has none.
int CalibrationToSheets(const ImportedCalibration& calibration) {
  if (calibration.imu && calibration.imu_is_per_sample) {
    return Report(Status::Input("convert: " + FLAGS_calibration +
                                ": gives the IMU noise per sample; converting it to densities needs the IMU "
                                "rate of a bag (--dataset)"));
  }
  if (const Status status = PrepareOutputFolder(FLAGS_output, FLAGS_overwrite); !status.ok()) {
    return Report(status);
  }
  if (calibration.imu) {
    const Status status =
        WriteFileAtomically(FLAGS_output + "/imu0/sensor.yaml",
                            ImuSensorYaml(calibration.imu->noise, calibration.imu->rate_hz.value_or(0)));
    if (!status.ok()) {
      return Report(status);
    }
  }
  if (!calibration.camera) {
    return kExitDone;
  }
  RigCalibration rig;
  rig.camera = calibration.camera->camera;
  rig.T_BC = calibration.camera->T_BC;
  rig.camera_time_offset_s = calibration.camera->time_offset_s;
  rig.line_delay_s = calibration.camera->line_delay_s;
  return Report(WriteFileAtomically(FLAGS_output + "/cam0/sensor.yaml",
                                    CameraSensorYaml(rig, calibration.camera->rate_hz.value_or(0))));
}

Result<ImportedCalibration> CalibrationFromFlags() {
  return FLAGS_calibration.empty() ? ImportedCalibration()
                                   : ImportCalibration(SplitWords(FLAGS_calibration), FLAGS_camera);
}

}  // namespace

int RunConvert(const std::vector<std::string>&) {
  if (const Status status = MakeBagTopics(FLAGS_topics).status(); !status.ok()) {
    return Report(Status(status.code(), "convert: " + status.message()));
  }
  const std::optional<BagCompression> compression = ParseBagCompression(FLAGS_compression);
  if (!compression) {
    return Report(Status::Usage("convert: --compression: found '" + FLAGS_compression +
                                "', expected none, bz2 or lz4"));
  }
  const Result<ImportedCalibration> calibration = CalibrationFromFlags();
  if (!calibration.ok()) {
    return Report(calibration.status());
  }
  if (IsBag(FLAGS_dataset)) {
    return BagToFolder(*calibration);
  }
  if (FLAGS_dataset.empty() == FLAGS_calibration.empty()) {
    return Report(Status::Usage(
        "convert: expected --dataset, of a bag also with --calibration, or --calibration alone"));
  }
  if (FLAGS_dataset.empty()) {
    return CalibrationToSheets(*calibration);
  }
  if (!FLAGS_output.ends_with(".bag")) {
    return Report(Status::Usage(
        "convert: --output: found '" + FLAGS_output +
        "', expected a name that ends in .bag (convert turns a folder into a bag, or a bag into a folder)"));
  }
  return FolderToBag(*compression);
}

}  // namespace alidade::cli
