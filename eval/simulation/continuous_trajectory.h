#pragma once

#include <Eigen/Core>

#include "core/navigation_state.h"

namespace alidade {

/// Motion of the body at one instant: pose and velocity, and what an ideal IMU at the body's origin would
/// feel of it.
struct Kinematics {
  NavState nav;                                              ///< R_WB, p_WB [m], v_WB [m/s]
  Eigen::Vector3d acceleration_W = Eigen::Vector3d::Zero();  ///< d v_WB / dt [m/s^2], gravity not included
  Eigen::Vector3d angular_rate_B = Eigen::Vector3d::Zero();  ///< of B against W, in B [rad/s]: dR/dt = R [w]x

  /// Specific force in B [m/s^2]: R^T (a - g) with g = (0, 0, -gravity).
  [[nodiscard]] Eigen::Vector3d SpecificForce(double gravity_mps2) const {
    return nav.R_WB.transpose() * (acceleration_W + Eigen::Vector3d(0, 0, gravity_mps2));
  }
};

/// A smooth motion of the body through the world, known at every instant. Velocity, acceleration and angular
/// rate are the exact derivatives of position and rotation, so that simulated sensors agree with each other
/// to rounding.
class ContinuousTrajectory {
 public:
  virtual ~ContinuousTrajectory() = default;

  /// The motion `time_s` seconds after the start of the sequence. Defined for times in [0, DurationSeconds()]
  /// and a little beyond (a camera with a time offset looks there).
  [[nodiscard]] virtual Kinematics At(double time_s) const = 0;
  [[nodiscard]] virtual double DurationSeconds() const = 0;
};

}  // namespace alidade
