#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/camera_model.h"
#include "core/status.h"
#include "eval/calibrate/frame_pairs.h"

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

struct CameraGyroFitOptions {
  CameraGyroError prior = CameraGyroPrior();
  double pixel_noise_px = 0.5;
  bool estimate_noise = true;  ///< from the residuals; pixel_noise_px is then its first value
  int iterations = 30;
  double block_s = 3;  ///< errors of pairs further apart than this are taken as independent
};

struct CameraGyroFit {
  CameraGyroModel model;
  /// Standard deviations: the larger ones of those by the information at the estimate, and of those by the
  /// scatter of what blocks of block_s and of twice that move the estimate by, which holds for errors that
  /// are correlated or not modelled. At most the prior's.
  CameraGyroError deviations = CameraGyroError::Zero();
  double residual_px = 0;  ///< robust deviation of the distances from the epipolar lines
  double outliers = 0;     ///< share of views beyond four of it
  /// Mean ratio of the variances to those by the information alone.
  double inflation = 1;
  double cost = 0;  ///< robust cost a view
  int pairs = 0;
  int views = 0;
  bool converged = false;
};

/// Camera and gyroscope from the epipolar geometry of frame pairs, without structure, scale, gravity or
/// accelerometer. With R_ij from the gyroscope, the rays f of a landmark obey t . (f_i x R_ij f_j) = 0; the
/// direction t of each pair is a parameter of its own (two angles), eliminated from each step. Rows are
/// distances from the epipolar line over their noise (Sampson 1982) with a Cauchy kernel, their Jacobians are
/// taken at the corrected rays, so that they share no noise with the residual. Levenberg-Marquardt over bias,
/// rotation, time offset, readout time and intrinsics. A pair is a rotation-only constraint where there is no
/// parallax.
///
/// Errors (kInput): fewer than 6 pairs.
Result<CameraGyroFit> FitCameraToGyro(const std::vector<FramePair>& pairs, const std::vector<ImuSample>& imu,
                                      const CameraGyroModel& start, const CameraGyroFitOptions& options);

}  // namespace alidade
