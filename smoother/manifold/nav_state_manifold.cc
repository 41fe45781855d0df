#include "smoother/manifold/nav_state_manifold.h"

#include <Eigen/Geometry>

namespace alidade {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Matrix3x4 = Eigen::Matrix<double, 3, 4>;
using Matrix4x3 = Eigen::Matrix<double, 4, 3>;
using PlusMatrix = Eigen::Matrix<double, kNavAmbientSize, kNavTangentSize, Eigen::RowMajor>;
using MinusMatrix = Eigen::Matrix<double, kNavTangentSize, kNavAmbientSize, Eigen::RowMajor>;
using ConstQuaternion = Eigen::Map<const Eigen::Quaterniond>;

/// d q / d theta at 0 for q Exp(theta), or for Exp(theta) q when the error stands on the left; 4x3, rows x y
/// z w.
Matrix4x3 QuaternionJacobian(const Eigen::Quaterniond& q, bool error_on_left) {
  Matrix4x3 jacobian;
  const double sign = error_on_left ? -1.0 : 1.0;
  jacobian.topRows<3>() = 0.5 * (q.w() * Matrix3d::Identity() + sign * Skew(q.vec()));
  jacobian.row(3) = -0.5 * q.vec().transpose();
  return jacobian;
}

}  // namespace

void PackNavState(const NavState& state, double* block) {
  Eigen::Map<Eigen::Quaterniond> q(block);
  q = Eigen::Quaterniond(state.R_WB);
  q.normalize();
  Eigen::Map<Vector3d>(block + 4) = state.p_WB;
  Eigen::Map<Vector3d>(block + 7) = state.v_WB;
}

NavState UnpackNavState(const double* block) {
  return {ConstQuaternion(block).normalized().toRotationMatrix(), Eigen::Map<const Vector3d>(block + 4),
          Eigen::Map<const Vector3d>(block + 7)};
}

ImuBias UnpackBias(const double* block) {
  return {Eigen::Map<const Eigen::Vector3d>(block), Eigen::Map<const Eigen::Vector3d>(block + 3)};
}

void PackBias(const ImuBias& bias, double* block) {
  Eigen::Map<Eigen::Vector3d>{block} = bias.gyro;
  Eigen::Map<Eigen::Vector3d>{block + 3} = bias.accel;
}

Matrix3x4 RotationLift(const double* block) {
  return 4.0 * QuaternionJacobian(ConstQuaternion(block).normalized(), false).transpose();
}

NavState NavStateManifold::Relative(const double* block) const {
  NavState state = UnpackNavState(block);
  state.p_WB -= p_center_;
  state.v_WB -= v_center_;
  return state;
}

bool NavStateManifold::Plus(const double* x, const double* delta, double* x_plus_delta) const {
  const Eigen::Quaterniond q = ConstQuaternion(x);
  NavState next = Retract(convention_, Relative(x), Eigen::Map<const Vector9d>(delta));
  next.p_WB += p_center_;
  next.v_WB += v_center_;
  PackNavState(next, x_plus_delta);
  Eigen::Map<Eigen::Vector4d> q_next(x_plus_delta);
  if (q_next.dot(q.coeffs()) < 0) {  // of the two quaternions of a rotation, the one next to x
    q_next = -q_next;
  }
  return true;
}

bool NavStateManifold::PlusJacobian(const double* x, double* jacobian) const {
  const NavState state = Relative(x);
  const bool right_invariant = convention_ == ErrorConvention::kRightInvariant;
  Eigen::Map<PlusMatrix> j(jacobian);
  j.setZero();
  j.topLeftCorner<4, 3>() = QuaternionJacobian(ConstQuaternion(x).normalized(), right_invariant);
  // The rows of p and v are those of the chart Jacobian: both give d(p, v) / d xi.
  j.bottomRows<6>() = ChartJacobian(convention_, state).bottomRows<6>();
  return true;
}

bool NavStateManifold::Minus(const double* y, const double* x, double* y_minus_x) const {
  Eigen::Map<Vector9d>{y_minus_x} = Local(convention_, Relative(x), Relative(y));
  return true;
}

bool NavStateManifold::MinusJacobian(const double* x, double* jacobian) const {
  const NavState state = Relative(x);
  const bool right_invariant = convention_ == ErrorConvention::kRightInvariant;
  Eigen::Map<MinusMatrix> j(jacobian);
  j.setZero();
  const Matrix3x4 theta =
      4.0 * QuaternionJacobian(ConstQuaternion(x).normalized(), right_invariant).transpose();
  const Matrix9d inverse = InverseChartJacobian(convention_, state);
  j.topLeftCorner<3, 4>() = theta;
  j.bottomRightCorner<6, 6>() = inverse.bottomRightCorner<6, 6>();
  if (right_invariant) {  // x - Exp(theta) x^: the rotation part of the block moves p and v as well
    j.block<3, 4>(3, 0) = Skew(state.p_WB) * theta;
    j.block<3, 4>(6, 0) = Skew(state.v_WB) * theta;
  }
  return true;
}

Matrix9d LocalJacobian(ErrorConvention convention, const NavState& origin, const NavState& state) {
  const Vector9d xi = Local(convention, origin, state);
  const Vector3d theta = xi.head<3>();
  Matrix9d j = Matrix9d::Identity();
  switch (convention) {
    case ErrorConvention::kRightInvariant:  // Exp(d) Exp(theta); x - ... = Exp(d) xi_x + d_x
      j.topLeftCorner<3, 3>() = so3::LeftJacobianInverse(theta);
      j.block<3, 3>(3, 0) = -Skew(xi.segment<3>(3));
      j.block<3, 3>(6, 0) = -Skew(xi.tail<3>());
      break;
    case ErrorConvention::kLeftInvariant: {
      const Matrix3d relative = origin.R_WB.transpose() * state.R_WB;
      j.topLeftCorner<3, 3>() = so3::RightJacobianInverse(theta);
      j.block<3, 3>(3, 3) = relative;
      j.block<3, 3>(6, 6) = relative;
      break;
    }
    case ErrorConvention::kSo3xRn:
      j.topLeftCorner<3, 3>() = so3::RightJacobianInverse(theta);
      break;
  }
  return j;
}

}  // namespace alidade
