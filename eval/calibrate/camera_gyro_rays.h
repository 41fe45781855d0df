#pragma once

#include <Eigen/Core>

#include "eval/calibrate/camera_gyro_model.h"
#include "eval/calibrate/frame_pairs.h"
#include "eval/calibrate/gyro_path.h"
#include "frontend/initialization/epipolar_ray.h"

namespace alidade {

/// Rows of a ray over (focal, ratio, centre, lens).
using LensRows = Eigen::Matrix<double, 3, CameraGyroCoordinate::kCount - CameraGyroCoordinate::kFocal>;

/// A pixel's unit ray in its camera.
struct RowRay {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();
  double sigma = 0;      ///< angle of one pixel [rad]
  double pixel_row = 0;  ///< row / height - 1/2
};

/// One frame of a pair at the present model.
struct FrameMotion {
  double t_s = 0;                                      ///< IMU time of the middle row
  Eigen::Matrix3d R_0B = Eigen::Matrix3d::Identity();  ///< body to the first body
  Eigen::Vector3d rate_C = Eigen::Vector3d::Zero();    ///< of the camera, in its own axes [rad/s]
};

/// Camera orientations of a pair at the present model.
struct PairMotion {
  FrameMotion i, j;
  Eigen::Matrix3d R_ij = Eigen::Matrix3d::Identity();  ///< camera j to camera i
  Eigen::Matrix3d bias_j = Eigen::Matrix3d::Zero();    ///< R_ij(b + d) = R_ij Exp(bias_j d)
};

[[nodiscard]] PairMotion MotionOf(const FramePair& pair, const CameraGyroModel& model, const GyroPath& path);

/// One view of a pair at a model: its rays in the middle rows' cameras.
struct ViewRays {
  bool seen = false;
  RowRay i, j;
  EpipolarRay epipolar;
};

/// seen: false where the lens cannot take one of the pixels. noise_px: of a pixel's coordinate.
[[nodiscard]] ViewRays RaysOf(const PairView& view, const CameraGyroModel& model, const PairMotion& motion,
                              const GyroPath& path, double noise_px);

/// d direction / d (focal, ratio, centre, lens) at `direction` [unit length]: the pixel is kept. Zero where
/// the lens does not see.
[[nodiscard]] LensRows IntrinsicsOfRay(const CameraModel& camera, const Eigen::Vector3d& direction);

}  // namespace alidade
