#pragma once

#include <Eigen/Core>

#include "core/camera_model.h"

namespace alidade {

/// What relates a camera to the gyroscope of its rig.
struct CameraGyroModel {
  CameraModel camera;
  Eigen::Matrix3d R_BC = Eigen::Matrix3d::Identity();  ///< camera to body
  double time_offset_s = 0;  ///< t_imu = t_camera + offset, of the image's middle row
  double readout_s = 0;      ///< a row is exposed at the middle row's time + readout (row / height - 1/2)
  Eigen::Vector3d gyro_bias = Eigen::Vector3d::Zero();
  double gyro_sign = 1;  ///< -1: the gyroscope's axes form a left-handed system
};

/// Coordinates of the error of a CameraGyroModel. kRotation: R_BC = R^ Exp(phi). kFocal: common factor of fu
/// and fv, 1 + error; kFocalRatio: of fu / fv. The others are additive, in rad/s, s, px and 1.
struct CameraGyroCoordinate {
  enum : int {
    kGyroBias = 0,
    kRotation = 3,
    kTimeOffset = 6,
    kReadout = 7,
    kFocal = 8,
    kFocalRatio = 9,
    kCentre = 10,
    kLens = 12,
    kCount = 17
  };
};
using CameraGyroError = Eigen::Matrix<double, CameraGyroCoordinate::kCount, 1>;
using CameraGyroMatrix = Eigen::Matrix<double, CameraGyroCoordinate::kCount, CameraGyroCoordinate::kCount>;

/// Moves a model by `error`; false, with `model` untouched, when that is no camera.
bool Retract(const CameraGyroError& error, CameraGyroModel* model);

/// The error with Retract(error, from) == to.
[[nodiscard]] CameraGyroError CameraGyroOffset(const CameraGyroModel& from, const CameraGyroModel& to);

/// Prior standard deviations about the given model; 0 holds a coordinate fixed. By default bias, rotation and
/// time offset are free.
[[nodiscard]] CameraGyroError CameraGyroPrior();

}  // namespace alidade
