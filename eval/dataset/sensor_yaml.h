#pragma once

#include <optional>
#include <string>

#include "core/rig_calibration.h"
#include "core/status.h"

namespace alidade {

struct ImuSensor {
  ImuNoise noise;
  std::optional<double> rate_hz;
};

/// Of a camera's time_offset_s [s], either sign; stamps that are further off are to be shifted.
inline constexpr double kMostCameraOffsetS = 10;

struct CameraSensor {
  CameraModel camera;
  Pose T_BC;
  std::optional<double> rate_hz;
  double time_offset_s = 0;  ///< t_imu = t_camera + offset; key time_offset_s
  double line_delay_s = 0;   ///< of a rolling shutter (core/rig_calibration.h); key line_delay_s
};

/// Reads imu0/sensor.yaml. The body frame is this sensor, so T_BS, when given, is the identity. Errors
/// (kInput) name file:line:column, key, value and expectation.
Result<ImuSensor> ReadImuSensor(const std::string& path);

/// Reads cam0/sensor.yaml: T_BS (camera to body, row-major 4x4), resolution, intrinsics (fu fv cu cv),
/// distortion_model, distortion_coefficients; optional time_offset_s, line_delay_s. Instead of T_BS the
/// extrinsics may have the name of another convention: T_imu_cam and body_T_cam0 mean the same transform,
/// T_cam_imu its inverse. A rotation off by rounding (1e-3) is made orthonormal; beyond that it is an error.
/// Errors (kInput) as above.
Result<CameraSensor> ReadCameraSensor(const std::string& path);

/// The same from text; `where` stands for the file in messages.
Result<ImuSensor> ParseImuSensor(const std::string& text, const std::string& where);
Result<CameraSensor> ParseCameraSensor(const std::string& text, const std::string& where);

/// The text of both files; reading it back gives equal values. A rate of 0 is omitted.
[[nodiscard]] std::string ImuSensorYaml(const ImuNoise& noise, double rate_hz);
[[nodiscard]] std::string CameraSensorYaml(const RigCalibration& rig, double rate_hz);
/// Three numbers as a list.
[[nodiscard]] std::string VectorYaml(const Eigen::Vector3d& vector);

}  // namespace alidade
