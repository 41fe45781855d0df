#include "core/preintegration.h"

#include "core/check.h"

namespace alidade {

using Eigen::Matrix3d;
using Eigen::Vector3d;

void Preintegration::Add(const ImuSample& from, const ImuSample& to) {
  const double dt = SecondsBetween(from.stamp_ns, to.stamp_ns);
  DCHECK_GT(dt, 0);
  const Vector3d omega = 0.5 * (from.gyro + to.gyro) - bias_.gyro;
  const Vector3d accel_0 = from.accel - bias_.accel;
  const Vector3d accel_1 = to.accel - bias_.accel;
  const Matrix3d delta = so3::Exp(omega * dt);
  const Matrix3d right = so3::RightJacobian(omega * dt);
  const Matrix3d gamma_1 = gamma_ * delta;
  const Vector3d accel_mid = 0.5 * (gamma_ * accel_0 + gamma_1 * accel_1);
  const Matrix3d gamma_1_skew = gamma_1 * Skew(accel_1);
  const double dt2 = dt * dt;

  Matrix15d f = Matrix15d::Identity();
  const Matrix3d accel_theta = -0.5 * (gamma_ * Skew(accel_0) + gamma_1_skew * delta.transpose());
  const Matrix3d accel_bg = 0.5 * dt * gamma_1_skew * right;
  const Matrix3d accel_ba = -0.5 * (gamma_ + gamma_1);
  f.block<3, 3>(0, 3) = dt * Matrix3d::Identity();
  f.block<3, 3>(0, 6) = 0.5 * dt2 * accel_theta;
  f.block<3, 3>(0, 9) = 0.5 * dt2 * accel_bg;
  f.block<3, 3>(0, 12) = 0.5 * dt2 * accel_ba;
  f.block<3, 3>(3, 6) = dt * accel_theta;
  f.block<3, 3>(3, 9) = dt * accel_bg;
  f.block<3, 3>(3, 12) = dt * accel_ba;
  f.block<3, 3>(6, 6) = delta.transpose();
  f.block<3, 3>(6, 9) = -dt * right;

  // Noise enters like a bias change of opposite sign over this step alone.
  Eigen::Matrix<double, 15, 12> noise_input = Eigen::Matrix<double, 15, 12>::Zero();
  noise_input.block<9, 3>(0, 0) = -f.block<9, 3>(0, 12);
  noise_input.block<9, 3>(0, 3) = -f.block<9, 3>(0, 9);
  noise_input.block<6, 6>(9, 6) = dt * Eigen::Matrix<double, 6, 6>::Identity();
  Eigen::Matrix<double, 12, 1> variance;
  variance << Vector3d::Constant(noise_.accel_noise_density_mps2_sqrthz).array().square(),
      Vector3d::Constant(noise_.gyro_noise_density_radps_sqrthz).array().square(),
      Vector3d::Constant(noise_.gyro_random_walk_radps2_sqrthz).array().square(),
      Vector3d::Constant(noise_.accel_random_walk_mps3_sqrthz).array().square();
  variance /= dt;

  jacobian_ = f * jacobian_;
  const Matrix15d propagated =
      f * covariance_ * f.transpose() + noise_input * variance.asDiagonal() * noise_input.transpose();
  covariance_ = 0.5 * (propagated + propagated.transpose());
  alpha_ += beta_ * dt + 0.5 * dt2 * accel_mid;
  beta_ += accel_mid * dt;
  gamma_ = gamma_1;
  duration_s_ += dt;
}

void Preintegration::Add(std::span<const ImuSample> samples) {
  for (size_t k = 0; k + 1 < samples.size(); ++k) {
    Add(samples[k], samples[k + 1]);
  }
}

Preintegration::Increments Preintegration::Corrected(const ImuBias& bias) const {
  const Vector3d d_gyro = bias.gyro - bias_.gyro;
  const Vector3d d_accel = bias.accel - bias_.accel;
  return {alpha_ + jacobian_.block<3, 3>(0, 9) * d_gyro + jacobian_.block<3, 3>(0, 12) * d_accel,
          beta_ + jacobian_.block<3, 3>(3, 9) * d_gyro + jacobian_.block<3, 3>(3, 12) * d_accel,
          gamma_ * so3::Exp(jacobian_.block<3, 3>(6, 9) * d_gyro)};
}

void PreintegrationModel::Evaluate(const NavState& state_i, const ImuBias& bias_i, const NavState& state_j,
                                   const ImuBias& bias_j, Vector15d* residual, Matrix15d* jacobian_i,
                                   Matrix15d* jacobian_j) const {
  const Preintegration& pre = *preintegration;
  const double T = pre.duration_s();
  const Preintegration::Increments measured = pre.Corrected(bias_i);
  const Matrix3d Rt = state_i.R_WB.transpose();
  const Vector3d alpha = Rt * (state_j.p_WB - state_i.p_WB - state_i.v_WB * T - 0.5 * T * T * gravity_W);
  const Vector3d beta = Rt * (state_j.v_WB - state_i.v_WB - T * gravity_W);
  const Vector3d theta = so3::Log(measured.gamma.transpose() * Rt * state_j.R_WB);
  residual->segment<3>(0) = alpha - measured.alpha;
  residual->segment<3>(3) = beta - measured.beta;
  residual->segment<3>(6) = theta;
  residual->segment<3>(9) = bias_j.gyro - bias_i.gyro;
  residual->segment<3>(12) = bias_j.accel - bias_i.accel;
  const Matrix3d right_inverse = so3::RightJacobianInverse(theta);
  if (jacobian_i != nullptr) {
    Matrix15d& j = *jacobian_i;
    const Matrix15d& bias_jacobian = pre.jacobian();
    j.setZero();
    j.block<3, 3>(0, 0) = Skew(alpha);
    j.block<3, 3>(0, 3) = -Rt;
    j.block<3, 3>(0, 6) = -T * Rt;
    j.block<6, 6>(0, 9) = -bias_jacobian.block<6, 6>(0, 9);
    j.block<3, 3>(3, 0) = Skew(beta);
    j.block<3, 3>(3, 6) = -Rt;
    j.block<3, 3>(6, 0) = -right_inverse * state_j.R_WB.transpose() * state_i.R_WB;
    const Matrix3d theta_bg = bias_jacobian.block<3, 3>(6, 9);
    j.block<3, 3>(6, 9) = -so3::LeftJacobianInverse(theta) *
                          so3::RightJacobian(theta_bg * (bias_i.gyro - pre.bias().gyro)) * theta_bg;
    j.block<6, 6>(9, 9) = -Eigen::Matrix<double, 6, 6>::Identity();
  }
  if (jacobian_j != nullptr) {
    jacobian_j->setZero();
    jacobian_j->block<3, 3>(0, 3) = Rt;
    jacobian_j->block<3, 3>(3, 6) = Rt;
    jacobian_j->block<3, 3>(6, 0) = right_inverse;
    jacobian_j->block<6, 6>(9, 9).setIdentity();
  }
}

}  // namespace alidade
