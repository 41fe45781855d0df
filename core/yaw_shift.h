#pragma once

#include "core/navigation_state.h"

namespace alidade {

/// Transform between two gravity-aligned frames W and N: a rotation by yaw about the vertical and a shift,
///
///   p_N = Rz(yaw) p_W + p_NW,   v_N = Rz(yaw) v_W,   R_NB = Rz(yaw) R_WB.
///
/// These four numbers are what visual-inertial odometry cannot observe.
struct YawShift {
  double yaw_rad = 0;
  Eigen::Vector3d p_NW = Eigen::Vector3d::Zero();  ///< origin of W in N [m]

  [[nodiscard]] Eigen::Matrix3d Rotation() const;  ///< R_NW
  [[nodiscard]] NavState operator*(const NavState& state_W) const;
  [[nodiscard]] Pose operator*(const Pose& T_WB) const;
  /// Covariance included; biases stay.
  [[nodiscard]] NavEstimate operator*(const NavEstimate& estimate_W) const;

  /// d zeta_N / d (yaw, p_NW), 9x4: canonical chart (phi, dp, dv) of the transformed state `state_N`
  /// against the four parameters,
  ///
  ///   phi: R_NB^T e_z;   dp: e_z x (p_N - p_NW), I;   dv: e_z x v_N.
  [[nodiscard]] Eigen::Matrix<double, 9, 4> ParameterJacobian(const NavState& state_N) const;
  /// d zeta_N / d zeta_W = blockdiag(I, R_NW, R_NW), 9x9, of the canonical charts of both states.
  [[nodiscard]] Matrix9d StateJacobian() const;
};

}  // namespace alidade
