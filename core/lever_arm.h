#pragma once

#include "core/navigation_state.h"

namespace alidade {

/// A point A that is fixed on the body, at the lever arm p_BA:
///
///   p_WA = p_WB + R_WB p_BA,   v_WA = v_WB + R_WB (omega x p_BA),   omega = gyro - b_g.
///
/// Jacobians are 3x15 over the canonical coordinates (phi, dp, dv, dbg, dba), and may be null.
struct LeverArm {
  using Jacobian = Eigen::Matrix<double, 3, 15>;

  Eigen::Vector3d p_BA = Eigen::Vector3d::Zero();  ///< [m]

  /// p_WA [m].
  [[nodiscard]] Eigen::Vector3d Position(const NavState& state, Jacobian* jacobian = nullptr) const;
  /// v_WA [m/s]; gyro_radps: measured at that time.
  [[nodiscard]] Eigen::Vector3d Velocity(const NavState& state, const ImuBias& bias,
                                         const Eigen::Vector3d& gyro_radps,
                                         Jacobian* jacobian = nullptr) const;

  /// d p_WA / d p_BA; d v_WA / d p_BA is that times SwingByArm.
  [[nodiscard]] static const Eigen::Matrix3d& PositionByArm(const NavState& state) { return state.R_WB; }
  /// d (omega x p_BA) / d p_BA [rad/s].
  [[nodiscard]] static Eigen::Matrix3d SwingByArm(const ImuBias& bias, const Eigen::Vector3d& gyro_radps);
};

}  // namespace alidade
