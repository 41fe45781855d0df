#pragma once

#include <string>

#include "core/status.h"
#include "eval/files/strict_yaml.h"

namespace alidade {

/// A calibration of Basalt as parts of sensor.yaml, whose reader holds the values against what they may be.
struct BasaltTexts {
  std::string camera;      ///< without extrinsics
  std::string extrinsics;  ///< empty: the file has none
  std::string offset;      ///< likewise
  std::string imu;         ///< empty: the file holds no noise of an IMU
};

/// `value0` of Basalt's calibration file. `camera` chooses among its cameras: cam0, cam1.
///
///   camera_type ds, eucm, kb4, pinhole as double-sphere, eucm, equidistant, none; resolution
///   T_imu_cam   p and unit quaternion, camera to IMU; cam_time_offset_ns, t_imu = t_camera + offset
///   IMU         gyro_noise_std, accel_noise_std, gyro_bias_std, accel_bias_std: densities of three axes, of
///               which the root mean square counts; imu_update_rate
///
/// Fixed biases and scale factors (calib_accel_bias, calib_gyro_bias) and vignettes are left out. Errors
/// (kInput): another camera_type, a key that is missing, a quaternion that is not of unit length.
Result<BasaltTexts> TranslateBasalt(const std::string& path, const YAML::Node& value0,
                                    const std::string& camera);

}  // namespace alidade
