#pragma once

#include "core/bearing_plane.h"
#include "core/navigation_state.h"

namespace alidade {

/// Reprojection of a landmark (x, y, rho) that is anchored in another camera (core/reprojection.h):
/// r = pi(R_C^T (R_A (x, y, 1) + rho (p_A - p_C))) - z, on the plane of the observation; (x, y, 1) is a
/// direction of the anchor's plane. With (x, y) the anchor's own
/// observation, taken as exact, it is the model of Qin et al. 2018 with rho alone unknown.
struct InverseDepthModel {
  Eigen::Vector2d z;
  BearingPlane plane = {};         ///< of the observation
  BearingPlane anchor_plane = {};  ///< of the landmark's coordinates

  using PoseJacobian = Eigen::Matrix<double, 2, 6>;
  using LandmarkJacobian = Eigen::Matrix<double, 2, 3>;

  /// Jacobians over (phi, dp) of the anchor's camera and of the view, and over (x, y, rho). False, with
  /// nothing written, when the landmark is not in front of the view (kMinScaledDepth).
  bool Evaluate(const Pose& T_WA, const Pose& T_WC, const Eigen::Vector3d& landmark,
                Eigen::Vector2d* residual, PoseJacobian* jacobian_anchor, PoseJacobian* jacobian_view,
                LandmarkJacobian* jacobian_landmark) const;
};

}  // namespace alidade
