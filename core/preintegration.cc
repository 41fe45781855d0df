#include "core/preintegration.h"

#include "core/check.h"
#include "core/imu_gap.h"
#include "core/imu_step.h"
#include "core/imu_vibration.h"
#include "core/semi_definite.h"

namespace alidade {

using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

bool HasFaultyAxis(const ImuSample& sample) {
  return !sample.gyro_fault_density_radps_sqrthz.isZero(0) ||
         !sample.accel_fault_density_mps2_sqrthz.isZero(0);
}

}  // namespace

void Preintegration::Add(const ImuSample& from, const ImuSample& to, const ImuNoise& noise) {
  const double dt_s = SecondsBetween(from.stamp_ns, to.stamp_ns);
  DCHECK_GT(dt_s, 0);
  const StepMean mean = MeanOverStep(from, to, bias_);
  ImuIncrement step = StepIncrement(mean.gyro, mean.accel, dt_s, noise);
  // A force that grows within the step acts late on the position.
  step.motion.alpha -= dt_s * dt_s / 12 * (to.accel - from.accel);
  const Eigen::Matrix<double, 9, 3> over_gyro = step.bias_jacobian.leftCols<3>();
  const Eigen::Matrix<double, 9, 3> over_accel = step.bias_jacobian.rightCols<3>();
  step.bias_jacobian << over_gyro * mean.gyro_over_gyro + over_accel * mean.accel_over_gyro,
      over_accel * mean.gyro_over_gyro;
  if (HasFaultyAxis(to)) {
    AddAxisNoise(mean.gyro, mean.accel, dt_s, to.gyro_fault_density_radps_sqrthz,
                 to.accel_fault_density_mps2_sqrthz, &step.covariance);
  }
  increment_.Append(step);
}

void Preintegration::Add(std::span<const ImuSample> samples) {
  const ImuNoise noise = noise_.with_vibration ? AddVibration(samples, noise_) : noise_;
  for (size_t k = 0; k + 1 < samples.size(); ++k) {
    const ImuSample& from = samples[k];
    const ImuSample& to = samples[k + 1];
    Add(from, to, imu_gap::IsInside(from, to) ? imu_gap::AddNoise(from, to, noise) : noise);
  }
}

ImuMotion Preintegration::Corrected(const ImuBias& bias) const {
  return Corrected(bias, nullptr);
}

ImuMotion Preintegration::Corrected(const ImuBias& bias, ImuIncrement::BiasJacobian* jacobian) const {
  Vector6d change;
  change << bias.gyro - bias_.gyro, bias.accel - bias_.accel;
  const Vector9d shift = increment_.bias_jacobian * change;
  ImuMotion corrected = increment_.motion;
  corrected.gamma *= so3::Exp(shift.head<3>());
  corrected.alpha += shift.segment<3>(3);
  corrected.beta += shift.tail<3>();
  if (jacobian != nullptr) {
    *jacobian = increment_.bias_jacobian;
    jacobian->topRows<3>() =
        (so3::RightJacobian(shift.head<3>()) * increment_.bias_jacobian.topRows<3>()).eval();
  }
  return corrected;
}

bool Preintegration::NoiseRoot(Matrix15d* root) const {
  return SemiDefiniteCholesky(increment_.covariance, root);
}

bool Preintegration::Whitening(Matrix15d* whitening) const {
  Matrix15d root;
  if (!NoiseRoot(&root) || !(root.diagonal().minCoeff() > 0)) {
    return false;
  }
  whitening->setIdentity();
  root.triangularView<Eigen::Lower>().solveInPlace(*whitening);
  return whitening->allFinite();
}

void PreintegrationModel::Evaluate(const NavState& state_i, const ImuBias& bias_i, const NavState& state_j,
                                   const ImuBias& bias_j, Vector15d* residual, Matrix15d* jacobian_i,
                                   Matrix15d* jacobian_j) const {
  const double T = preintegration->duration_s();
  ImuIncrement::BiasJacobian bias_jacobian;
  const ImuMotion measured =
      preintegration->Corrected(bias_i, jacobian_i != nullptr ? &bias_jacobian : nullptr);
  const Matrix3d Rt = state_i.R_WB.transpose();
  const Vector3d theta = so3::Log(measured.gamma.transpose() * Rt * state_j.R_WB);
  const Vector3d alpha = Rt * (state_j.p_WB - state_i.p_WB - state_i.v_WB * T - 0.5 * T * T * gravity_W);
  const Vector3d beta = Rt * (state_j.v_WB - state_i.v_WB - T * gravity_W);
  *residual << theta, alpha - measured.alpha, beta - measured.beta, bias_j.gyro - bias_i.gyro,
      bias_j.accel - bias_i.accel;
  const Matrix3d right_inverse = so3::RightJacobianInverse(theta);
  if (jacobian_i != nullptr) {
    Matrix15d& j = *jacobian_i;
    j.setZero();
    j.block<3, 3>(0, 0) = -right_inverse * state_j.R_WB.transpose() * state_i.R_WB;
    j.block<3, 6>(0, 9) = -so3::LeftJacobianInverse(theta) * bias_jacobian.topRows<3>();
    j.block<3, 3>(3, 0) = Skew(alpha);
    j.block<3, 3>(3, 3) = -Rt;
    j.block<3, 3>(3, 6) = -T * Rt;
    j.block<3, 3>(6, 0) = Skew(beta);
    j.block<3, 3>(6, 6) = -Rt;
    j.block<6, 6>(3, 9) = -bias_jacobian.bottomRows<6>();
    j.block<6, 6>(9, 9) = -Matrix6d::Identity();
  }
  if (jacobian_j != nullptr) {
    jacobian_j->setZero();
    jacobian_j->block<3, 3>(0, 0) = right_inverse;
    jacobian_j->block<3, 3>(3, 3) = Rt;
    jacobian_j->block<3, 3>(6, 6) = Rt;
    jacobian_j->block<6, 6>(9, 9).setIdentity();
  }
}

}  // namespace alidade
