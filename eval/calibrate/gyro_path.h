#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/imu_sample.h"

namespace alidade {

/// Orientation of a body by its gyroscope alone. Times are seconds since the first sample.
class GyroPath {
 public:
  struct Point {
    Eigen::Matrix3d R_0t = Eigen::Matrix3d::Identity();  ///< body at t to body at the first sample
    Eigen::Vector3d rate_B = Eigen::Vector3d::Zero();    ///< [rad/s], bias removed
    Eigen::Matrix3d integral = Eigen::Matrix3d::Zero();  ///< of R_0t from the first sample on [s]
  };

  /// imu: at least two samples of strictly increasing stamps. gyro_sign: -1 reads the rates negated. The rate
  /// is linear between samples.
  GyroPath(const std::vector<ImuSample>& imu, const Eigen::Vector3d& bias, double gyro_sign);

  /// At t_s, which is clamped to the samples' span.
  [[nodiscard]] Point At(double t_s) const;

  /// d (rotation vector of R_0i^T R_0j) / d bias in the body at j: R_ij(b + d) = R_ij Exp(J d). 3x3.
  [[nodiscard]] static Eigen::Matrix3d BiasJacobian(const Point& i, const Point& j);

 private:
  std::vector<double> times_s_;
  std::vector<Point> points_;
};

}  // namespace alidade
