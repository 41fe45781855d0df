#pragma once

#include <Eigen/Core>

#include "core/imu_sample.h"
#include "core/lie.h"

namespace alidade {

/// Motion over an interval as the IMU measures it, whatever the state at its start (Lupton and Sukkarieh
/// 2012, Forster et al. 2017); a is the specific force less its bias:
///
///   gamma = R(t0, t1)                            rotation of the body at t1 in the body frame at t0
///   beta  = integral of R(t0, t) a dt            [m/s]
///   alpha = integral of beta dt                  [m]
struct ImuMotion {
  double duration_s = 0;
  Eigen::Matrix3d gamma = Eigen::Matrix3d::Identity();
  Eigen::Vector3d alpha = Eigen::Vector3d::Zero();
  Eigen::Vector3d beta = Eigen::Vector3d::Zero();

  /// This interval and the `next` one together.
  [[nodiscard]] ImuMotion operator*(const ImuMotion& next) const;
};

/// An ImuMotion with its first-order statistics. Its error is (theta, alpha, beta, bg, ba), 15x1, units rad,
/// m, m/s, rad/s, m/s^2: gamma = gamma^ Exp(theta), the rest additive, all in the body frame at t0. bg and ba
/// are the biases at t1.
struct ImuIncrement {
  using BiasJacobian = Eigen::Matrix<double, 9, 6>;

  ImuMotion motion;
  BiasJacobian bias_jacobian = BiasJacobian::Zero();  ///< d (theta, alpha, beta) / d (bg, ba) at t0
  Matrix15d covariance = Matrix15d::Zero();  ///< of the IMU's noise; walks of different axes independent

  /// Continues over the `next` interval, whose motion was computed with the same biases.
  void Append(const ImuIncrement& next);
};

/// One step of `dt_s` with constant angular rate `omega` [rad/s] and specific force `accel` [m/s^2], biases
/// removed. Closed form with Gamma_m of core/lie.h (Hartley et al. 2020):
///
///   gamma = Exp(w dt),  beta = Gamma_1(w dt) a dt,  alpha = Gamma_2(w dt) a dt^2
///
/// The bias Jacobian is exact. The covariance is the integral of the response to the four continuous-time
/// noises over the step, with the rotation held at the step's middle (relative error of order (|w| dt)^2).
[[nodiscard]] ImuIncrement StepIncrement(const Eigen::Vector3d& omega, const Eigen::Vector3d& accel,
                                         double dt_s, const ImuNoise& noise);

/// Adds to the covariance of that step the white noise of single axes of the body: densities of gyroscope
/// [rad/s/sqrt(Hz)] and accelerometer [m/s^2/sqrt(Hz)]. Equal ones have the effect of those of ImuNoise.
void AddAxisNoise(const Eigen::Vector3d& omega, const Eigen::Vector3d& accel, double dt_s,
                  const Eigen::Vector3d& gyro_densities, const Eigen::Vector3d& accel_densities,
                  Matrix15d* covariance);

}  // namespace alidade
