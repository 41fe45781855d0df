#pragma once

#include <Eigen/Core>

#include "eval/calibrate/camera_gyro_rays.h"

namespace alidade {

/// Scale of the Cauchy kernel over a whitened row.
inline constexpr double kCameraGyroKernelSigma = 2.5;

/// Normal equations of one frame pair (FitCameraToGyro) with the direction of its translation eliminated, and
/// what gives the direction's step back: -direction_step - direction_by_model * step of the model.
struct CameraGyroEquations {
  CameraGyroMatrix information = CameraGyroMatrix::Zero();
  CameraGyroError gradient = CameraGyroError::Zero();
  Eigen::Matrix<double, 2, CameraGyroCoordinate::kCount> direction_by_model =
      Eigen::Matrix<double, 2, CameraGyroCoordinate::kCount>::Zero();
  Eigen::Vector2d direction_step = Eigen::Vector2d::Zero();
};

/// At `model`, whose gyroscope `path` has, and at the unit vector `direction` of the pair's translation.
/// intrinsics_free: else their columns are zero. noise_px: of a pixel's coordinate.
[[nodiscard]] CameraGyroEquations EquationsOf(const FramePair& pair, const CameraGyroModel& model,
                                              const GyroPath& path, const Eigen::Vector3d& direction,
                                              bool intrinsics_free, double noise_px);

/// The unit vector moved by two angles [rad] along its tangent plane, in the axes of direction_step.
[[nodiscard]] Eigen::Vector3d MovedDirection(const Eigen::Vector3d& direction, const Eigen::Vector2d& angles);

}  // namespace alidade
