#pragma once

#include "core/rig_calibration.h"
#include "frontend/initialization/dynamic_window.h"

namespace alidade {

/// The gyroscope's bias from the epipolar geometry.
struct GyroBiasFit {
  Eigen::Vector3d gyro_bias = Eigen::Vector3d::Zero();
  std::vector<bool> inlier;  ///< one a track of the window
  double median_parallax_px =
      0;  ///< rotation-compensated motion of the tracks over their life, at the mean focal length
};

/// Gyroscope bias from vision without scale, structure or gravity: for frames i, j the rays obey
/// t_ij . (f_i x R_ij(b_g) f_j) = 0, R_ij from the gyroscope (Kneip and Lynen 2013; with the gyroscope's
/// rotation as in He et al. 2023). Every pair's translation direction t_ij is the least eigenvector of sum w
/// n n^T, and is eliminated from the Gauss-Newton step on the three biases, shared by all pairs. Robust
/// weights; tracks that disagree in most of their pairs are marked. Prior on the bias: zero, 0.1 rad/s. Works
/// without parallax too (then only the marks mean little). preintegrations: of the window, about any bias
/// near the truth. Needs at least two frames.
[[nodiscard]] GyroBiasFit FitGyroBias(const DynamicWindow& window,
                                      const std::vector<Preintegration>& preintegrations,
                                      const RigCalibration& rig);

}  // namespace alidade
