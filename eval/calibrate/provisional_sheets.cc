#include "eval/calibrate/provisional_sheets.h"

#include <filesystem>

#include "core/camera_model.h"
#include "core/rig_calibration.h"
#include "eval/dataset/dataset_images.h"
#include "eval/dataset/sensor_table.h"
#include "eval/dataset/sensor_yaml.h"
#include "eval/files/input_file.h"
#include "eval/files/output_file.h"
#include "frontend/tracking/image_reader.h"

namespace alidade {
namespace {

namespace fs = std::filesystem;

/// Of phones and cheap modules, in motion.
constexpr ImuNoise kConsumerImu = {1e-3, 1e-2, 1e-4, 1e-3};

Result<GreyImage> FirstImage(const fs::path& folder, bool follow_links) {
  const std::string path = (folder / "data.csv").string();
  Result<CsvReader> csv = OpenTable(path, {{"timestamp", "ns"}, {"filename"}});
  if (!csv.ok()) {
    return Status::Input((folder / "sensor.yaml").string() +
                         ": missing, and no list of images from which to guess a camera: " + csv.message());
  }
  if (!csv->NextRow()) {
    return Status::Input(path + ": lists no image, expected at least one row");
  }
  ALIDADE_RETURN_IF_ERROR(csv->ExpectColumns(2));
  const Result<std::string> image = ImageFolder(folder.string(), follow_links).PathOf(*csv);
  ALIDADE_RETURN_IF_ERROR(image.status());
  return ReadGreyImage(*image);
}

Result<std::string> GuessedCamera(const fs::path& folder, bool follow_links) {
  const Result<GreyImage> image = FirstImage(folder, follow_links);
  ALIDADE_RETURN_IF_ERROR(image.status());
  constexpr double kFocalShare = 0.8;
  const double focal = kFocalShare * image->width_px;
  Result<CameraModel> camera =
      CameraModel::Create(DistortionModel::kRadialTangential,
                          {focal, focal, (image->width_px - 1) / 2.0, (image->height_px - 1) / 2.0},
                          {0, 0, 0, 0}, image->width_px, image->height_px);
  ALIDADE_RETURN_IF_ERROR(camera.status());
  RigCalibration rig;
  rig.camera = *camera;
  return CameraSensorYaml(rig, 0);
}

Status Link(const fs::path& from, const fs::path& to) {
  std::error_code error;
  fs::create_symlink(fs::absolute(from), to, error);
  return error
             ? Status::Output(to.string() + ": cannot be linked to " + from.string() + ": " + error.message())
             : Status::Ok();
}

/// Links the entries of a folder of `mav` but its sheet, and writes this sheet.
Status LinkWithSheet(const fs::path& mav, const char* name, const fs::path& staging,
                     const std::string& sheet) {
  std::error_code error;
  fs::create_directories(staging / name, error);
  for (const fs::directory_entry& entry : fs::directory_iterator(mav / name, error)) {
    if (entry.path().filename() != "sensor.yaml") {
      ALIDADE_RETURN_IF_ERROR(Link(entry.path(), staging / name / entry.path().filename()));
    }
  }
  if (error) {
    return Status::Output((staging / name).string() + ": " + error.message());
  }
  return WriteFileAtomically((staging / name / "sensor.yaml").string(), sheet);
}

}  // namespace

Result<ProvisionalSequence> CompleteSheets(const std::string& path, const std::string& staging,
                                           bool follow_links) {
  const fs::path mav = fs::path(path) / "mav0";
  ProvisionalSequence sequence{path};
  std::error_code ignored;
  fs::remove_all(staging, ignored);  // of a process that was killed
  sequence.camera =
      fs::is_directory(mav / "cam0", ignored) && !fs::exists(mav / "cam0" / "sensor.yaml", ignored);
  sequence.imu_noise =
      fs::is_directory(mav / "imu0", ignored) && !fs::exists(mav / "imu0" / "sensor.yaml", ignored);
  if (!sequence.camera && !sequence.imu_noise) {
    return sequence;
  }
  sequence.path = staging;
  const fs::path staged = fs::path(staging) / "mav0";
  std::error_code error;
  fs::create_directories(staged, error);
  if (error) {
    return Status::Output(staged.string() + ": " + error.message());
  }
  if (sequence.camera) {
    const Result<std::string> camera = GuessedCamera(mav / "cam0", follow_links);
    ALIDADE_RETURN_IF_ERROR(camera.status());
    ALIDADE_RETURN_IF_ERROR(LinkWithSheet(mav, "cam0", staged, *camera));
  }
  if (sequence.imu_noise) {
    ALIDADE_RETURN_IF_ERROR(LinkWithSheet(mav, "imu0", staged, ImuSensorYaml(kConsumerImu, 0)));
  }
  for (const fs::directory_entry& entry : fs::directory_iterator(mav, error)) {
    if (!fs::exists(staged / entry.path().filename(), ignored)) {
      ALIDADE_RETURN_IF_ERROR(Link(entry.path(), staged / entry.path().filename()));
    }
  }
  return error ? Status::Input(mav.string() + ": " + error.message()) : Result<ProvisionalSequence>(sequence);
}

}  // namespace alidade
