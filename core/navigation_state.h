#pragma once

#include "core/lie.h"
#include "core/status.h"
#include "core/time.h"

namespace alidade {

/// Rigid transform T_AB: p_A = rotation * p_B + translation. Default: identity.
struct Pose {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  [[nodiscard]] Eigen::Vector3d operator*(const Eigen::Vector3d& p) const;
  [[nodiscard]] Pose operator*(const Pose& other) const;
  [[nodiscard]] Pose Inverse() const;
};

/// Navigation state of the body (IMU) in the gravity-aligned world W: R_WB, p_WB [m], v_WB [m/s].
struct NavState {
  Eigen::Matrix3d R_WB = Eigen::Matrix3d::Identity();
  Eigen::Vector3d p_WB = Eigen::Vector3d::Zero();
  Eigen::Vector3d v_WB = Eigen::Vector3d::Zero();

  [[nodiscard]] Pose T_WB() const { return {R_WB, p_WB}; }
};

/// Additive IMU biases: gyroscope [rad/s], accelerometer [m/s^2]; measured = true + bias + noise.
struct ImuBias {
  Eigen::Vector3d gyro = Eigen::Vector3d::Zero();
  Eigen::Vector3d accel = Eigen::Vector3d::Zero();
};

/// What every estimator reports and every comparison reads: state and covariance at one stamp.
struct NavEstimate {
  TimeNs stamp_ns = 0;
  NavState nav;
  ImuBias bias;
  /// Covariance in the canonical chart (phi, dp, dv, dbg, dba): R = R^ Exp(phi), the rest additive. Units
  /// rad, m, m/s, rad/s, m/s^2. See core/error_convention.h.
  Matrix15d covariance = Matrix15d::Zero();
};

/// True when every number of it is finite.
[[nodiscard]] bool IsFinite(const NavEstimate& estimate);

/// What an estimator can start from. kInput: a number is not finite, R_WB is no rotation, or the covariance
/// is not symmetric positive semi-definite (to 1e-6, 1e-9 and 1e-12 relative).
Status CheckInitialState(const NavEstimate& initial);

}  // namespace alidade
