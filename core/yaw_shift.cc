#include "core/yaw_shift.h"

#include <Eigen/Geometry>

namespace alidade {

using Eigen::Vector3d;

Eigen::Matrix3d YawShift::Rotation() const {
  return Eigen::AngleAxisd(yaw_rad, Vector3d::UnitZ()).toRotationMatrix();
}

NavState YawShift::operator*(const NavState& state_W) const {
  const Eigen::Matrix3d R_NW = Rotation();
  return {R_NW * state_W.R_WB, R_NW * state_W.p_WB + p_NW, R_NW * state_W.v_WB};
}

Pose YawShift::operator*(const Pose& T_WB) const {
  const Eigen::Matrix3d R_NW = Rotation();
  return {R_NW * T_WB.rotation, R_NW * T_WB.translation + p_NW};
}

NavEstimate YawShift::operator*(const NavEstimate& estimate_W) const {
  NavEstimate estimate_N = estimate_W;
  estimate_N.nav = *this * estimate_W.nav;
  Matrix15d chart = Matrix15d::Identity();
  chart.topLeftCorner<9, 9>() = StateJacobian();
  const Matrix15d covariance = chart * estimate_W.covariance * chart.transpose();
  estimate_N.covariance = 0.5 * (covariance + covariance.transpose());
  return estimate_N;
}

Eigen::Matrix<double, 9, 4> YawShift::ParameterJacobian(const NavState& state_N) const {
  Eigen::Matrix<double, 9, 4> jacobian = Eigen::Matrix<double, 9, 4>::Zero();
  jacobian.block<3, 1>(0, 0) = state_N.R_WB.transpose() * Vector3d::UnitZ();
  jacobian.block<3, 1>(3, 0) = Vector3d::UnitZ().cross(state_N.p_WB - p_NW);
  jacobian.block<3, 1>(6, 0) = Vector3d::UnitZ().cross(state_N.v_WB);
  jacobian.block<3, 3>(3, 1).setIdentity();
  return jacobian;
}

Matrix9d YawShift::StateJacobian() const {
  Matrix9d jacobian = Matrix9d::Identity();
  jacobian.block<3, 3>(3, 3) = Rotation();
  jacobian.block<3, 3>(6, 6) = jacobian.block<3, 3>(3, 3);
  return jacobian;
}

}  // namespace alidade
