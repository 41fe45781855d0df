#pragma once

#include "core/navigation_state.h"
#include "core/visual_observation.h"

namespace alidade {

/// Reprojection of a landmark given by its inverse depth rho in a base view whose bearing is taken as exact
/// (Qin et al. 2018): p_W = p_b + R_b z_b / rho; r = pi(R_k^T (p_W - p_k)) - z_k, on the normalised plane.
/// Evaluated without dividing by rho, so rho -> 0 (a landmark at infinity) is regular.
struct InverseDepthModel {
  Eigen::Vector2d z_base;
  Eigen::Vector2d z;

  using PoseJacobian = Eigen::Matrix<double, 2, 6>;

  /// Jacobians over (phi, dp) of the base view and of the other view, over rho [1/m], and (for a caller who
  /// estimates the base bearing, or propagates its noise) over z_base. False when the landmark is behind the
  /// view. The base's own residual vanishes by construction and is not a measurement.
  bool Evaluate(const Pose& T_WC_base, const Pose& T_WC, double inverse_depth, Eigen::Vector2d* residual,
                PoseJacobian* jacobian_base, PoseJacobian* jacobian_view, Eigen::Vector2d* jacobian_rho,
                Eigen::Matrix2d* jacobian_bearing = nullptr) const;
};

}  // namespace alidade
