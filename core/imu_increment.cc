#include "core/imu_increment.h"

namespace alidade {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// First rows of the blocks of the error.
constexpr int kTheta = 0;
constexpr int kAlpha = 3;
constexpr int kBeta = 6;
constexpr int kBg = 9;
constexpr int kBa = 12;

/// d (theta, alpha, beta)(t2) / d (theta, alpha, beta)(t1), as the motion from t1 to t2 moves them.
struct ErrorFlow {
  Matrix3d theta_theta, alpha_theta, beta_theta;
  double duration_s;

  ErrorFlow(const Matrix3d& gamma, const ImuMotion& next)
      : theta_theta(next.gamma.transpose()),
        alpha_theta(-gamma * Skew(next.alpha)),
        beta_theta(-gamma * Skew(next.beta)),
        duration_s(next.duration_s) {}

  template <int kColumns>
  [[nodiscard]] Eigen::Matrix<double, 9, kColumns> operator*(
      const Eigen::Matrix<double, 9, kColumns>& m) const {
    Eigen::Matrix<double, 9, kColumns> out;
    const Eigen::Matrix<double, 3, kColumns> theta = m.template middleRows<3>(kTheta);
    out.template middleRows<3>(kTheta) = theta_theta.lazyProduct(theta);
    out.template middleRows<3>(kAlpha) = m.template middleRows<3>(kAlpha) +
                                         duration_s * m.template middleRows<3>(kBeta) +
                                         alpha_theta.lazyProduct(theta);
    out.template middleRows<3>(kBeta) = m.template middleRows<3>(kBeta) + beta_theta.lazyProduct(theta);
    return out;
  }
};

/// Rows of (theta, alpha, beta) of a later interval, alpha and beta turned into the frame of t0.
template <int kColumns>
Eigen::Matrix<double, 9, kColumns> Turned(const Matrix3d& gamma,
                                          const Eigen::Matrix<double, 9, kColumns>& rows) {
  Eigen::Matrix<double, 9, kColumns> out;
  out.template middleRows<3>(kTheta) = rows.template middleRows<3>(kTheta);
  out.template middleRows<3>(kAlpha) = gamma.lazyProduct(rows.template middleRows<3>(kAlpha));
  out.template middleRows<3>(kBeta) = gamma.lazyProduct(rows.template middleRows<3>(kBeta));
  return out;
}

/// Writes the block and, off the diagonal, its transpose.
void Set(Matrix15d* covariance, int row, int column, const Matrix3d& block) {
  covariance->block<3, 3>(row, column) = block;
  if (row != column) {
    covariance->block<3, 3>(column, row) = block.transpose();
  }
}

/// Squared densities of one sensor, integrated over a step.
struct StepNoise {
  double white = 0;
  double walk = 0;
};

/// Products of the responses at a step's end to noise a lag s before, without their powers of s: gyroscope
/// white noise -E, A s, A s^2/2 in theta, beta, alpha; accelerometer white noise -M, -M s in beta, alpha; of
/// their walks the integrals of those over s.
struct ResponseProducts {
  Matrix3d EEt, AEt, AAt, MMt;
};

/// Covariance blocks of (theta, alpha, beta): the products, integrated over s from 0 to dt.
void SetMotionBlocks(const ResponseProducts& response, const StepNoise& gyro, const StepNoise& accel,
                     double dt, Matrix15d* q) {
  const double g = gyro.white, wg = gyro.walk;
  const double a = accel.white, wa = accel.walk;
  const auto& [EEt, AEt, AAt, MMt] = response;
  const double dt2 = dt * dt;
  const double dt3 = dt2 * dt;
  const double dt4 = dt2 * dt2;
  Set(q, kTheta, kTheta, (g + wg * dt2 / 3) * EEt);
  Set(q, kAlpha, kTheta, -(g * dt2 / 6 + wg * dt4 / 30) * AEt);
  Set(q, kBeta, kTheta, -(g * dt / 2 + wg * dt3 / 8) * AEt);
  Set(q, kAlpha, kAlpha, (a * dt2 / 3 + wa * dt4 / 20) * MMt + (g * dt4 / 20 + wg * dt4 * dt2 / 252) * AAt);
  Set(q, kAlpha, kBeta, (a * dt / 2 + wa * dt3 / 8) * MMt + (g * dt3 / 8 + wg * dt4 * dt / 72) * AAt);
  Set(q, kBeta, kBeta, (a + wa * dt2 / 3) * MMt + (g * dt2 / 3 + wg * dt4 / 20) * AAt);
}

/// Of all noises of a step. A walk's response in its own bias is 1.
Matrix15d StepCovariance(const Matrix3d& M, const Matrix3d& E, const Vector3d& accel, double dt,
                         const ImuNoise& noise) {
  const double g = noise.gyro_noise_density_radps_sqrthz * noise.gyro_noise_density_radps_sqrthz * dt;
  const double a = noise.accel_noise_density_mps2_sqrthz * noise.accel_noise_density_mps2_sqrthz * dt;
  const double wg = noise.gyro_random_walk_radps2_sqrthz * noise.gyro_random_walk_radps2_sqrthz * dt;
  const double wa = noise.accel_random_walk_mps3_sqrthz * noise.accel_random_walk_mps3_sqrthz * dt;
  const Matrix3d I = Matrix3d::Identity();
  const Matrix3d A = M * Skew(accel);
  const double dt2 = dt * dt;
  const double dt3 = dt2 * dt;
  Matrix15d q = Matrix15d::Zero();
  SetMotionBlocks({I, A * E.transpose(), A * A.transpose(), I}, {g, wg}, {a, wa}, dt, &q);
  Set(&q, kTheta, kBg, -wg * dt / 2 * E);
  Set(&q, kAlpha, kBg, wg * dt3 / 24 * A);
  Set(&q, kBeta, kBg, wg * dt2 / 6 * A);
  Set(&q, kAlpha, kBa, -wa * dt2 / 6 * M);
  Set(&q, kBeta, kBa, -wa * dt / 2 * M);
  Set(&q, kBg, kBg, wg * I);
  Set(&q, kBa, kBa, wa * I);
  return q;
}

}  // namespace

ImuMotion ImuMotion::operator*(const ImuMotion& next) const {
  return {duration_s + next.duration_s, gamma * next.gamma,
          alpha + next.duration_s * beta + gamma * next.alpha, beta + gamma * next.beta};
}

void ImuIncrement::Append(const ImuIncrement& next) {
  const Matrix3d gamma = motion.gamma;
  const ErrorFlow flow(gamma, next.motion);
  const BiasJacobian of_bias = Turned(gamma, next.bias_jacobian);
  const BiasJacobian cross = flow * BiasJacobian(covariance.topRightCorner<9, 6>());
  const auto walk = covariance.diagonal().tail<6>().asDiagonal();
  const Matrix9d half = flow * Matrix9d(covariance.topLeftCorner<9, 9>());
  const Matrix9d flown = flow * Matrix9d(half.transpose());
  const BiasJacobian of_walk = of_bias * walk;
  const Matrix9d mixed = BiasJacobian(cross + 0.5 * of_walk).lazyProduct(of_bias.transpose());
  const Matrix9d own =
      Turned(gamma, Matrix9d(Turned(gamma, Matrix9d(next.covariance.topLeftCorner<9, 9>())).transpose()));
  const Matrix9d sum = flown + own + 2 * mixed;
  covariance.topLeftCorner<9, 9>() = 0.5 * (sum + sum.transpose());
  covariance.topRightCorner<9, 6>() =
      cross + of_walk + Turned(gamma, BiasJacobian(next.covariance.topRightCorner<9, 6>()));
  covariance.bottomLeftCorner<6, 9>() = covariance.topRightCorner<9, 6>().transpose();
  covariance.diagonal().tail<6>() += Vector6d(next.covariance.diagonal().tail<6>());
  bias_jacobian = flow * bias_jacobian + of_bias;
  motion = motion * next.motion;
}

ImuIncrement StepIncrement(const Vector3d& omega, const Vector3d& accel, double dt_s, const ImuNoise& noise) {
  const Vector3d angle = omega * dt_s;
  const Matrix3d gamma_1 = so3::Gamma(angle, 1);
  const Matrix3d gamma_2 = so3::Gamma(angle, 2);
  const double dt2 = dt_s * dt_s;
  ImuIncrement step;
  step.motion = {dt_s, so3::Exp(angle), gamma_2 * accel * dt2, gamma_1 * accel * dt_s};
  step.bias_jacobian.block<3, 3>(kTheta, 0) = -gamma_1.transpose() * dt_s;  // the right Jacobian
  step.bias_jacobian.block<3, 3>(kAlpha, 0) = -so3::GammaDerivative(angle, accel, 2) * dt2 * dt_s;
  step.bias_jacobian.block<3, 3>(kAlpha, 3) = -gamma_2 * dt2;
  step.bias_jacobian.block<3, 3>(kBeta, 0) = -so3::GammaDerivative(angle, accel, 1) * dt2;
  step.bias_jacobian.block<3, 3>(kBeta, 3) = -gamma_1 * dt_s;
  const Matrix3d middle = so3::Exp(0.5 * angle);
  step.covariance = StepCovariance(middle, step.motion.gamma.transpose() * middle, accel, dt_s, noise);
  return step;
}

void AddAxisNoise(const Vector3d& omega, const Vector3d& accel, double dt_s, const Vector3d& gyro_densities,
                  const Vector3d& accel_densities, Matrix15d* covariance) {
  // The noise of each axis in its own direction; E = M^T.
  const Matrix3d M = so3::Exp(0.5 * dt_s * omega);
  const Matrix3d A = M * Skew(accel);
  const Matrix3d G = (dt_s * gyro_densities.cwiseAbs2()).asDiagonal();
  const Matrix3d AG = A * G;
  const Matrix3d force = M * (dt_s * accel_densities.cwiseAbs2()).asDiagonal() * M.transpose();
  Matrix15d q = Matrix15d::Zero();
  SetMotionBlocks({M.transpose() * G * M, AG * M, AG * A.transpose(), force}, {1, 0}, {1, 0}, dt_s, &q);
  *covariance += q;
}

}  // namespace alidade
