#include "core/imu_propagation.h"

#include "core/check.h"

namespace alidade {

using Eigen::Matrix3d;

Matrix15d ImuTransition::q() const {
  return noise_root * noise_root.transpose();
}

NavState CarryState(const Preintegration& preintegration, const NavState& nav, const ImuBias& bias,
                    const Eigen::Vector3d& gravity_W, Matrix15d* phi) {
  ImuIncrement::BiasJacobian of_bias;
  const ImuMotion motion = preintegration.Corrected(bias, phi != nullptr ? &of_bias : nullptr);
  const double dt_s = motion.duration_s;
  const Matrix3d& R = nav.R_WB;
  if (phi != nullptr) {
    phi->setIdentity();
    phi->block<3, 3>(0, 0) = motion.gamma.transpose();
    phi->block<3, 6>(0, 9) = of_bias.topRows<3>();
    phi->block<3, 3>(3, 0) = -R * Skew(motion.alpha);
    phi->block<3, 3>(3, 6) = dt_s * Matrix3d::Identity();
    phi->block<3, 6>(3, 9) = R * of_bias.middleRows<3>(3);
    phi->block<3, 3>(6, 0) = -R * Skew(motion.beta);
    phi->block<3, 6>(6, 9) = R * of_bias.bottomRows<3>();
  }
  return {R * motion.gamma, nav.p_WB + dt_s * nav.v_WB + 0.5 * dt_s * dt_s * gravity_W + R * motion.alpha,
          nav.v_WB + dt_s * gravity_W + R * motion.beta};
}

Status PropagateState(const Preintegration& preintegration, const Eigen::Vector3d& gravity_W, NavState* nav,
                      ImuTransition* transition) {
  Matrix15d phi;
  Matrix15d root;
  const NavState end = CarryState(preintegration, *nav, preintegration.bias(), gravity_W, &phi);
  if (!end.R_WB.allFinite() || !end.p_WB.allFinite() || !end.v_WB.allFinite() || !phi.allFinite() ||
      !preintegration.NoiseRoot(&root) || !root.allFinite()) {
    return Status::Diverged("the IMU integrates to numbers that are not finite");
  }
  transition->phi = phi;
  transition->noise_root = root;
  // The increments of position and velocity are in the body frame at the start.
  transition->noise_root.middleRows<3>(3) = nav->R_WB * root.middleRows<3>(3);
  transition->noise_root.middleRows<3>(6) = nav->R_WB * root.middleRows<3>(6);
  *nav = end;
  return Status::Ok();
}

Status PropagateEstimate(std::span<const ImuSample> samples, const ImuNoise& noise,
                         const Eigen::Vector3d& gravity_W, NavEstimate* estimate) {
  CHECK_GE(samples.size(), 2u);
  Preintegration preintegration(estimate->bias, noise);
  preintegration.Add(samples);
  ImuTransition transition;
  ALIDADE_RETURN_IF_ERROR(PropagateState(preintegration, gravity_W, &estimate->nav, &transition));
  estimate->covariance = transition.phi * estimate->covariance * transition.phi.transpose() + transition.q();
  estimate->stamp_ns = samples.back().stamp_ns;
  return Status::Ok();
}

}  // namespace alidade
