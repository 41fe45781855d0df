#pragma once

#include <Eigen/Core>

#include "core/time.h"

namespace alidade {

/// One inertial measurement in the body frame: angular rate [rad/s] and specific force [m/s^2].
struct ImuSample {
  TimeNs stamp_ns = 0;
  Eigen::Vector3d gyro = Eigen::Vector3d::Zero();
  Eigen::Vector3d accel = Eigen::Vector3d::Zero();
  double gap_s = 0;  ///< of an interpolated one: time between the measured samples around it
  // Second derivatives of the parabola through this measured sample and the two before it [rad/s^3, m/s^4];
  // zero where they are not known. An interpolated sample has those of the measured one after it.
  Eigen::Vector3d gyro_curvature = Eigen::Vector3d::Zero();
  Eigen::Vector3d accel_curvature = Eigen::Vector3d::Zero();
  // White noise that a fault of single axes adds in the step that ends here (eval/run/imu_axis_watch.h).
  Eigen::Vector3d gyro_fault_density_radps_sqrthz = Eigen::Vector3d::Zero();
  Eigen::Vector3d accel_fault_density_mps2_sqrthz = Eigen::Vector3d::Zero();
};

/// Continuous-time noise of an IMU (one axis), EuRoC's sensor.yaml units.
struct ImuNoise {
  double gyro_noise_density_radps_sqrthz = 3e-4;
  double accel_noise_density_mps2_sqrthz = 1e-3;
  double gyro_random_walk_radps2_sqrthz = 3e-5;
  double accel_random_walk_mps3_sqrthz = 2e-4;
  /// Whether vibration that the samples show adds to the white noise (core/imu_vibration.h).
  bool with_vibration = false;
};

}  // namespace alidade
