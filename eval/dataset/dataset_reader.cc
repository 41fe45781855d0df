#include "eval/dataset/dataset_reader.h"

#include <filesystem>
#include <utility>

#include "eval/dataset/dataset_camera.h"
#include "eval/dataset/dataset_fix.h"
#include "eval/dataset/dataset_gnss.h"
#include "eval/dataset/sensor_yaml.h"
#include "eval/files/csv.h"
#include "eval/trajectory/trajectory_reader.h"

namespace alidade {
namespace {

namespace fs = std::filesystem;

Result<std::vector<ImuSample>> ReadImu(const std::string& path) {
  // Units are required here: a gyroscope in deg/s or an accelerometer in g must not pass for SI.
  const std::vector<CsvColumn> header = {{"timestamp", "ns"},
                                         {"w_RS_S_x", "rad s^-1", true},
                                         {"w_RS_S_y", "rad s^-1", true},
                                         {"w_RS_S_z", "rad s^-1", true},
                                         {"a_RS_S_x", "m s^-2", true},
                                         {"a_RS_S_y", "m s^-2", true},
                                         {"a_RS_S_z", "m s^-2", true}};
  Result<CsvReader> csv = OpenTable(path, header);
  if (!csv.ok()) {
    return csv.status();
  }
  std::vector<ImuSample> imu;
  while (csv->NextRow()) {
    ALIDADE_RETURN_IF_ERROR(csv->ExpectColumns(header.size()));
    ImuSample sample;
    ALIDADE_RETURN_IF_ERROR(
        csv->ReadStamp(imu.empty(), imu.empty() ? 0 : imu.back().stamp_ns, &sample.stamp_ns));
    for (int i = 0; i < 3; ++i) {
      const size_t column = static_cast<size_t>(i) + 1;
      ALIDADE_RETURN_IF_ERROR(csv->ReadReal(column, header[column].name, &sample.gyro[i]));
      ALIDADE_RETURN_IF_ERROR(csv->ReadReal(column + 3, header[column + 3].name, &sample.accel[i]));
    }
    imu.push_back(sample);
  }
  if (imu.size() < 2) {
    return Status::Input(path + ": holds " + std::to_string(imu.size()) + " samples, expected at least two");
  }
  return imu;
}

Status ReadTruth(const fs::path& folder, Dataset* dataset) {
  for (const char* name : {"data.csv", "data_pose.csv", "data_position.csv"}) {
    const fs::path path = folder / name;
    if (!fs::exists(path)) {
      continue;
    }
    Result<Trajectory> truth = ReadTrajectory(path.string());
    ALIDADE_RETURN_IF_ERROR(truth.status());
    dataset->truth = std::move(truth).value();
    dataset->truth_path = path.string();
    return Status::Ok();
  }
  if (fs::is_directory(folder)) {
    return Status::Input(folder.string() +
                         ": expected data.csv, data_pose.csv or data_position.csv; found none");
  }
  return Status::Ok();
}

Status CheckFolders(const std::string& path, const fs::path& mav) {
  if (!fs::is_directory(path)) {
    return Status::Input(path + ": no such folder, expected a sequence (a folder that holds mav0)");
  }
  if (!fs::is_directory(mav)) {
    const bool inside = fs::is_directory(fs::path(path) / "imu0");
    return Status::Input(path + ": expected a folder mav0 in it" +
                         (inside ? " (this seems to be mav0 itself: give the folder that contains it)" : ""));
  }
  if (!fs::is_directory(mav / "cam0") && !fs::is_directory(mav / "gnss0")) {
    return Status::Input((mav / "cam0").string() +
                         ": no such folder, expected a camera (or gnss0 beside it)");
  }
  return Status::Ok();
}

}  // namespace

Result<Dataset> ReadDataset(const std::string& path) {
  const fs::path mav = fs::path(path) / "mav0";
  ALIDADE_RETURN_IF_ERROR(CheckFolders(path, mav));
  Dataset dataset;
  dataset.path = path;
  std::error_code ignored;
  const fs::path whole = fs::weakly_canonical(path, ignored);
  dataset.name = whole.has_filename() ? whole.filename().string() : whole.parent_path().filename().string();

  const Result<ImuSensor> imu_sensor = ReadImuSensor((mav / "imu0" / "sensor.yaml").string());
  ALIDADE_RETURN_IF_ERROR(imu_sensor.status());
  dataset.rig.imu_noise = imu_sensor->noise;
  Result<std::vector<ImuSample>> imu = ReadImu((mav / "imu0" / "data.csv").string());
  ALIDADE_RETURN_IF_ERROR(imu.status());
  dataset.imu = std::move(imu).value();
  dataset.imu_rate_hz = imu_sensor->rate_hz.value_or(
      MeasuredRate(dataset.imu.front().stamp_ns, dataset.imu.back().stamp_ns, dataset.imu.size()));
  if (fs::is_directory(mav / "cam0")) {
    ALIDADE_RETURN_IF_ERROR(ReadCameraFolder((mav / "cam0").string(), &dataset));
    ALIDADE_RETURN_IF_ERROR(ReadExtraCameras(mav.string(), &dataset));
  }
  if (fs::is_directory(mav / "gnss0")) {
    ALIDADE_RETURN_IF_ERROR(ReadGnssFolder((mav / "gnss0").string(), &dataset));
  }
  ALIDADE_RETURN_IF_ERROR(ReadFixFolders(mav.string(), &dataset));
  ALIDADE_RETURN_IF_ERROR(ReadTruth(mav / "state_groundtruth_estimate0", &dataset));
  if (!dataset.truth && fs::is_directory(mav / "mocap0")) {  // TUM VI's name
    ALIDADE_RETURN_IF_ERROR(ReadTruth(mav / "mocap0", &dataset));
  }
  return dataset;
}

}  // namespace alidade
