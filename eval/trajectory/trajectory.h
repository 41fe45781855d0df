#pragma once

#include <vector>

#include "core/navigation_state.h"
#include "core/status.h"

namespace alidade {

/// Covariances of velocity in W [m/s] and of the biases [rad/s, m/s^2]; the errors are additive, truth -
/// estimate.
struct MotionCovariance {
  Eigen::Matrix3d velocity = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d gyro_bias = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d accel_bias = Eigen::Matrix3d::Zero();
};

/// One row of a trajectory file. Fields that the file does not contain stay zero; Trajectory has flags
/// for those that it contains.
struct TrajectoryPoint {
  TimeNs stamp_ns = 0;
  NavState nav;
  ImuBias bias;
  Matrix6d covariance = Matrix6d::Zero();  ///< canonical chart (phi, dp)
  MotionCovariance motion_covariance;      ///< zero: unknown; no trajectory file has it
};

/// A time-ordered trajectory of the body frame, from truth, an estimate or another program.
struct Trajectory {
  std::vector<TrajectoryPoint> points;  ///< strictly increasing stamps
  bool has_orientation = true;          ///< false: rotations are the identity and unused
  bool has_velocity = false;
  bool has_bias = false;
  bool has_covariance = false;
};

}  // namespace alidade
