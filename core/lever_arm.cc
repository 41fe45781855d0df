#include "core/lever_arm.h"

#include "core/lie.h"

namespace alidade {

using Eigen::Vector3d;

Vector3d LeverArm::Position(const NavState& state, Jacobian* jacobian) const {
  if (jacobian != nullptr) {
    jacobian->setZero();
    jacobian->block<3, 3>(0, 0) = -state.R_WB * Skew(p_BA);
    jacobian->block<3, 3>(0, 3).setIdentity();
  }
  return state.p_WB + state.R_WB * p_BA;
}

Vector3d LeverArm::Velocity(const NavState& state, const ImuBias& bias, const Vector3d& gyro_radps,
                            Jacobian* jacobian) const {
  const Vector3d swing = (gyro_radps - bias.gyro).cross(p_BA);
  if (jacobian != nullptr) {
    jacobian->setZero();
    jacobian->block<3, 3>(0, 0) = -state.R_WB * Skew(swing);
    jacobian->block<3, 3>(0, 6).setIdentity();
    jacobian->block<3, 3>(0, 9) = state.R_WB * Skew(p_BA);
  }
  return state.v_WB + state.R_WB * swing;
}

Eigen::Matrix3d LeverArm::SwingByArm(const ImuBias& bias, const Vector3d& gyro_radps) {
  return Skew(Vector3d(gyro_radps - bias.gyro));
}

}  // namespace alidade
