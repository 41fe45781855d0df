#pragma once

#include <vector>

#include "core/imu_sample.h"
#include "core/status.h"
#include "eval/calibrate/camera_gyro_model.h"
#include "eval/calibrate/frame_pairs.h"

namespace alidade {

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
