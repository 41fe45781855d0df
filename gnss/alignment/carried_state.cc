#include "gnss/alignment/carried_state.h"

namespace alidade {

NavState CarryState(const Preintegration& preintegration, const NavState& nav, const ImuBias& bias,
                    const Eigen::Vector3d& gravity_W, Matrix15d* jacobian) {
  const Preintegration::Increments d = preintegration.Corrected(bias);
  const double dt_s = preintegration.duration_s();
  const Eigen::Matrix3d& R = nav.R_WB;
  if (jacobian != nullptr) {
    const Matrix15d& J = preintegration.jacobian();
    jacobian->setIdentity();
    jacobian->block<3, 3>(0, 0) = d.gamma.transpose();
    jacobian->block<3, 6>(0, 9) = J.block<3, 6>(6, 9);
    jacobian->block<3, 3>(3, 0) = -R * Skew(d.alpha);
    jacobian->block<3, 3>(3, 6) = dt_s * Eigen::Matrix3d::Identity();
    jacobian->block<3, 6>(3, 9) = R * J.block<3, 6>(0, 9);
    jacobian->block<3, 3>(6, 0) = -R * Skew(d.beta);
    jacobian->block<3, 6>(6, 9) = R * J.block<3, 6>(3, 9);
  }
  return {R * d.gamma, nav.p_WB + dt_s * nav.v_WB + 0.5 * dt_s * dt_s * gravity_W + R * d.alpha,
          nav.v_WB + dt_s * gravity_W + R * d.beta};
}

}  // namespace alidade
