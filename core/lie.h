#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace alidade {

using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Matrix9d = Eigen::Matrix<double, 9, 9>;
using Matrix15d = Eigen::Matrix<double, 15, 15>;
using Vector6d = Eigen::Matrix<double, 6, 1>;
using Vector9d = Eigen::Matrix<double, 9, 1>;
using Vector15d = Eigen::Matrix<double, 15, 1>;

/// [v]x, so that Skew(v) * w = v x w.
[[nodiscard]] inline Eigen::Matrix3d Skew(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

/// SO(3). Rotation vectors in radians; formulas of Sola, Deray, Atchuthan, "A micro Lie theory for state
/// estimation in robotics", 2018, with Taylor series below the angle where the closed form loses digits.
namespace so3 {

/// Exp: rotation vector -> rotation matrix (Rodrigues).
[[nodiscard]] Eigen::Matrix3d Exp(const Eigen::Vector3d& phi);
/// Log: rotation matrix -> rotation vector, |phi| <= pi. Accurate near 0 and near pi.
[[nodiscard]] Eigen::Vector3d Log(const Eigen::Matrix3d& rotation);
/// Left Jacobian: Exp(phi + d) = Exp(J_l(phi) d) Exp(phi) to first order.
[[nodiscard]] Eigen::Matrix3d LeftJacobian(const Eigen::Vector3d& phi);
/// Right Jacobian: Exp(phi + d) = Exp(phi) Exp(J_r(phi) d) to first order. J_r(phi) = J_l(-phi).
[[nodiscard]] Eigen::Matrix3d RightJacobian(const Eigen::Vector3d& phi);
[[nodiscard]] Eigen::Matrix3d LeftJacobianInverse(const Eigen::Vector3d& phi);
[[nodiscard]] Eigen::Matrix3d RightJacobianInverse(const Eigen::Vector3d& phi);
/// Gamma_m(phi) = sum_k [phi]x^k / (k + m)!; Gamma_0 = Exp, Gamma_1 = J_l, Gamma_2 and Gamma_3 integrate
/// specific force over a constant rotation rate (Bloesch et al. 2012, Hartley et al. 2020 appendix). Shape
/// 3x3, m in 0..3.
[[nodiscard]] Eigen::Matrix3d Gamma(const Eigen::Vector3d& phi, int m);
/// d (Gamma_m(phi) v) / d phi, m in 0..2.
[[nodiscard]] Eigen::Matrix3d GammaDerivative(const Eigen::Vector3d& phi, const Eigen::Vector3d& v, int m);
/// The rotation matrix nearest to `m` in the Frobenius norm. Of m = sum_i b_i a_i^T: the one that turns the
/// a_i into the b_i with the least squares (Kabsch).
[[nodiscard]] Eigen::Matrix3d Normalize(const Eigen::Matrix3d& m);
/// The angle [rad] of the rotation about z nearest to `m` in the Frobenius norm, in [-pi, pi]. Of
/// m = sum_i b_i a_i^T: the one that turns the a_i about z into the b_i with the least squares. 0 where all
/// angles are as near.
[[nodiscard]] double NearestYaw(const Eigen::Matrix3d& m);
/// The least rotation that turns the direction of `from` into that of `to`.
[[nodiscard]] Eigen::Matrix3d Between(const Eigen::Vector3d& from, const Eigen::Vector3d& to);

}  // namespace so3

}  // namespace alidade
