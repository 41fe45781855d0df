#pragma once

#include <ceres/manifold.h>

#include "core/error_convention.h"

namespace alidade {

/// How a navigation state lies in a Ceres parameter block: unit Hamilton quaternion of R_WB (x, y, z, w),
/// p_WB, v_WB.
inline constexpr int kNavAmbientSize = 10;
inline constexpr int kNavTangentSize = 9;

void PackNavState(const NavState& state, double* block);
/// The quaternion is normalised on reading, so rounding in the block never leaves SO(3).
[[nodiscard]] NavState UnpackNavState(const double* block);

/// A bias block: gyroscope, accelerometer.
void PackBias(const ImuBias& bias, double* block);
[[nodiscard]] ImuBias UnpackBias(const double* block);

/// d zeta / d block, 9x10, of the canonical chart: phi = 2 vec(q^-1 dq), dp, dv. Only the 3x4 rotation part
/// is not the identity, so only it is kept. It equals C * MinusJacobian for EVERY convention (C the
/// convention's chart Jacobian: the terms that couple p and v to the rotation cancel), which is what makes
/// one cost function serve all manifolds:
///
///     (J_zeta * lift) * PlusJacobian = J_zeta * C * MinusJacobian * PlusJacobian = J_zeta * C.
[[nodiscard]] Eigen::Matrix<double, 3, 4> RotationLift(const double* block);

/// (R, p, v) as one block whose Plus and Minus are Retract and Local of an error convention, of the state
/// relative to a centre: Plus(x, d) = centre + Retract(x - centre, d) in p and v. The right-invariant error
/// turns about the world's origin; from 400 m away, a state that turns where it is needs a shift of 400 m
/// times the angle that cancels, and normal equations over such columns are ill conditioned. With a centre in
/// the window they are not. No factor depends on it, since their Jacobians are over the block.
class NavStateManifold final : public ceres::Manifold {
 public:
  explicit NavStateManifold(ErrorConvention convention,
                            const Eigen::Vector3d& p_center = Eigen::Vector3d::Zero(),
                            const Eigen::Vector3d& v_center = Eigen::Vector3d::Zero())
      : convention_(convention), p_center_(p_center), v_center_(v_center) {}

  [[nodiscard]] int AmbientSize() const override { return kNavAmbientSize; }
  [[nodiscard]] int TangentSize() const override { return kNavTangentSize; }
  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override;
  /// d Plus(x, delta) / d delta at 0: row-major 10x9.
  bool PlusJacobian(const double* x, double* jacobian) const override;
  bool Minus(const double* y, const double* x, double* y_minus_x) const override;
  /// d Minus(y, x) / d y at y = x: row-major 9x10; a left inverse of PlusJacobian.
  bool MinusJacobian(const double* x, double* jacobian) const override;

  [[nodiscard]] ErrorConvention convention() const { return convention_; }

 private:
  [[nodiscard]] NavState Relative(const double* block) const;

  ErrorConvention convention_;
  Eigen::Vector3d p_center_;
  Eigen::Vector3d v_center_;
};

/// d Local(origin, Retract(state, xi)) / d xi at xi = 0, 9x9: the identity where state == origin. A prior
/// anchored at `origin` needs it wherever the state has moved on.
[[nodiscard]] Matrix9d LocalJacobian(ErrorConvention convention, const NavState& origin,
                                     const NavState& state);

}  // namespace alidade
