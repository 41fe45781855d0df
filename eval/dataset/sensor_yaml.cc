#include "eval/dataset/sensor_yaml.h"

#include <cmath>
#include <vector>

#include "core/format.h"
#include "eval/dataset/sensor_file.h"
#include "eval/files/csv.h"
#include "eval/files/output_file.h"
#include "eval/files/strict_yaml.h"
#include "eval/files/suggest.h"

namespace alidade {
namespace {

Status ReadExtrinsics(const SensorFile& file, Pose* T_BC) {
  const char* found = nullptr;
  for (const char* key : {"T_BS", "T_imu_cam", "body_T_cam0", "T_cam_imu"}) {
    if (!file.Has(key)) {
      continue;
    }
    if (found != nullptr) {
      return file.Fault(key, std::string("no second transform beside ") + found);
    }
    found = key;
  }
  if (found == nullptr) {
    return file.Fault("T_BS",
                      "the camera-to-body transform (or T_imu_cam, body_T_cam0, T_cam_imu by that name)");
  }
  ALIDADE_RETURN_IF_ERROR(file.ReadTransform(found, T_BC));
  if (std::string_view(found) == "T_cam_imu") {
    *T_BC = T_BC->Inverse();
  }
  return Status::Ok();
}

Status ReadDistortionModel(const SensorFile& file, DistortionModel* model) {
  const std::string known = "one of radial-tangential, equidistant, fov, mei, double-sphere, eucm, none";
  if (!file.Has("distortion_model") || !file["distortion_model"].IsScalar()) {
    return file.Fault("distortion_model", known);
  }
  const std::string name = file["distortion_model"].Scalar();
  const std::optional<DistortionModel> parsed = ParseDistortionModel(name);
  if (!parsed.has_value()) {
    return file.Fault("distortion_model", known + Suggestion(name, {"radial-tangential", "equidistant", "fov",
                                                                    "mei", "double-sphere", "eucm", "none"}));
  }
  *model = *parsed;
  return Status::Ok();
}

Status ReadCamera(const SensorFile& file, const std::string& path, CameraModel* camera) {
  if (file.Has("camera_model") && file["camera_model"].as<std::string>("") != "pinhole") {
    return file.Fault("camera_model", "'pinhole'");
  }
  DistortionModel model = DistortionModel::kNone;
  ALIDADE_RETURN_IF_ERROR(ReadDistortionModel(file, &model));
  std::vector<double> intrinsics;
  std::vector<double> resolution;
  std::vector<double> coefficients;
  ALIDADE_RETURN_IF_ERROR(file.ReadReals("intrinsics", 4, &intrinsics));
  ALIDADE_RETURN_IF_ERROR(file.ReadReals("resolution", 2, &resolution));
  if (file.Has("distortion_coefficients") || model != DistortionModel::kNone) {
    ALIDADE_RETURN_IF_ERROR(file.ReadReals("distortion_coefficients", 0, &coefficients));
  }
  for (const double side : resolution) {
    if (side != std::floor(side) || side < 1 || side > 1e5) {
      return file.Fault("resolution", "width and height, whole and positive [px]");
    }
  }
  Result<CameraModel> created =
      CameraModel::Create(model, Eigen::Vector4d(intrinsics[0], intrinsics[1], intrinsics[2], intrinsics[3]),
                          coefficients, static_cast<int>(resolution[0]), static_cast<int>(resolution[1]));
  if (!created.ok()) {
    return Status::Input(path + ": " + created.message());
  }
  *camera = *created;
  return Status::Ok();
}

std::string TransformYaml(const Pose& transform) {
  std::string text = "T_BS:\n  cols: 4\n  rows: 4\n  data: [";
  for (int row = 0; row < 3; ++row) {
    for (int col = 0; col < 3; ++col) {
      text += ShortestDouble(transform.rotation(row, col)) + ", ";
    }
    text += ShortestDouble(transform.translation[row]) + ",\n         ";
  }
  return text + "0, 0, 0, 1]\n";
}

/// Whether other programs call it a lens of a pinhole camera.
bool IsPinhole(DistortionModel model) {
  return model != DistortionModel::kMei && model != DistortionModel::kDoubleSphere &&
         model != DistortionModel::kEucm;
}

std::string Line(const char* key, double value, const char* comment) {
  return std::string(key) + ": " + ShortestDouble(value) + comment + "\n";
}

/// Nothing for a rate that is not known.
std::string RateLine(double rate_hz) {
  return rate_hz > 0 ? Line("rate_hz", rate_hz, "") : std::string();
}

/// A density of zero makes propagation exact and every covariance built on it singular or too small.
Status ReadDensity(const SensorFile& file, const char* key, double* density) {
  ALIDADE_RETURN_IF_ERROR(file.ReadReal(key, 0, density));
  return *density > 0 ? Status::Ok() : file.Fault(key, "a noise density greater than 0");
}

/// Of either sign: a sensor that is mounted upside down reads its rows from below.
Status ReadLineDelay(const SensorFile& file, int height_px, double* line_delay_s) {
  constexpr double kMostReadoutS = 0.2;
  ALIDADE_RETURN_IF_ERROR(file.ReadReal("line_delay_s", -kMostReadoutS, line_delay_s));
  if (std::abs(*line_delay_s) * height_px > kMostReadoutS) {
    return file.Fault("line_delay_s", "the time from one row to the next [s]: " + std::to_string(height_px) +
                                          " rows within " + ShortestDouble(kMostReadoutS) + " s");
  }
  return Status::Ok();
}

Result<ImuSensor> MakeImuSensor(const Result<YAML::Node>& root, const std::string& path) {
  const Result<SensorFile> file = SensorFile::Make(root, path, "imu");
  if (!file.ok()) {
    return file.status();
  }
  if (file->Has("T_BS")) {
    Pose T_BS;
    ALIDADE_RETURN_IF_ERROR(file->ReadTransform("T_BS", &T_BS));
    if (!T_BS.rotation.isIdentity(1e-9) || !T_BS.translation.isZero(1e-9)) {
      return file->Fault("T_BS", "the identity: the body frame is this sensor");
    }
  }
  ImuSensor sensor;
  ALIDADE_RETURN_IF_ERROR(file->ReadRate(&sensor.rate_hz));
  ImuNoise& noise = sensor.noise;
  ALIDADE_RETURN_IF_ERROR(
      ReadDensity(*file, "gyroscope_noise_density", &noise.gyro_noise_density_radps_sqrthz));
  ALIDADE_RETURN_IF_ERROR(file->ReadReal("gyroscope_random_walk", 0, &noise.gyro_random_walk_radps2_sqrthz));
  ALIDADE_RETURN_IF_ERROR(
      ReadDensity(*file, "accelerometer_noise_density", &noise.accel_noise_density_mps2_sqrthz));
  ALIDADE_RETURN_IF_ERROR(
      file->ReadReal("accelerometer_random_walk", 0, &noise.accel_random_walk_mps3_sqrthz));
  return sensor;
}

Result<CameraSensor> MakeCameraSensor(const Result<YAML::Node>& root, const std::string& path) {
  const Result<SensorFile> file = SensorFile::Make(root, path, "camera");
  if (!file.ok()) {
    return file.status();
  }
  CameraSensor sensor;
  ALIDADE_RETURN_IF_ERROR(ReadExtrinsics(*file, &sensor.T_BC));
  ALIDADE_RETURN_IF_ERROR(file->ReadRate(&sensor.rate_hz));
  ALIDADE_RETURN_IF_ERROR(ReadCamera(*file, path, &sensor.camera));
  if (file->Has("time_offset_s")) {
    ALIDADE_RETURN_IF_ERROR(file->ReadReal("time_offset_s", -kMostCameraOffsetS, &sensor.time_offset_s));
    if (sensor.time_offset_s > kMostCameraOffsetS) {
      return file->Fault("time_offset_s", Format("a number within +-%.0f s", kMostCameraOffsetS));
    }
  }
  if (file->Has("line_delay_s")) {
    ALIDADE_RETURN_IF_ERROR(ReadLineDelay(*file, sensor.camera.height_px(), &sensor.line_delay_s));
  }
  return sensor;
}

}  // namespace

Result<ImuSensor> ReadImuSensor(const std::string& path) {
  return MakeImuSensor(ParseYamlFile(path, StatusCode::kInput), path);
}

Result<ImuSensor> ParseImuSensor(const std::string& text, const std::string& where) {
  return MakeImuSensor(ParseYaml(text, where, StatusCode::kInput), where);
}

Result<CameraSensor> ReadCameraSensor(const std::string& path) {
  return MakeCameraSensor(ParseYamlFile(path, StatusCode::kInput), path);
}

Result<CameraSensor> ParseCameraSensor(const std::string& text, const std::string& where) {
  return MakeCameraSensor(ParseYaml(text, where, StatusCode::kInput), where);
}

std::string ImuSensorYaml(const ImuNoise& noise, double rate_hz) {
  return "sensor_type: imu\n" + TransformYaml(Pose()) + RateLine(rate_hz) +
         Line("gyroscope_noise_density", noise.gyro_noise_density_radps_sqrthz, "  # rad s^-1 Hz^-0.5") +
         Line("gyroscope_random_walk", noise.gyro_random_walk_radps2_sqrthz, "  # rad s^-2 Hz^-0.5") +
         Line("accelerometer_noise_density", noise.accel_noise_density_mps2_sqrthz, "  # m s^-2 Hz^-0.5") +
         Line("accelerometer_random_walk", noise.accel_random_walk_mps3_sqrthz, "  # m s^-3 Hz^-0.5");
}

std::string CameraSensorYaml(const RigCalibration& rig, double rate_hz) {
  const CameraModel& camera = rig.camera;
  std::string text = "sensor_type: camera\n" + TransformYaml(rig.T_BC) + RateLine(rate_hz);
  text +=
      "resolution: [" + std::to_string(camera.width_px()) + ", " + std::to_string(camera.height_px()) + "]\n";
  text += IsPinhole(camera.model()) ? "camera_model: pinhole\n" : "";
  text += "intrinsics: [";
  for (int i = 0; i < 4; ++i) {
    text += (i > 0 ? ", " : "") + ShortestDouble(camera.intrinsics()[i]);
  }
  text += "]  # fu, fv, cu, cv [px]\ndistortion_model: " + std::string(ToString(camera.model())) +
          "\ndistortion_coefficients: [";
  for (int i = 0; i < CoefficientCount(camera.model()); ++i) {
    text += (i > 0 ? ", " : "") + ShortestDouble(camera.coefficients()[i]);
  }
  text += "]\n";
  if (rig.camera_time_offset_s != 0) {
    text += Line("time_offset_s", rig.camera_time_offset_s, "  # t_imu = t_camera + offset");
  }
  if (rig.line_delay_s != 0) {
    text += Line("line_delay_s", rig.line_delay_s,
                 "  # a row later, so much later; the stamp is of the middle row");
  }
  return text;
}

std::string VectorYaml(const Eigen::Vector3d& vector) {
  return "[" + ShortestDouble(vector.x()) + ", " + ShortestDouble(vector.y()) + ", " +
         ShortestDouble(vector.z()) + "]";
}

}  // namespace alidade
