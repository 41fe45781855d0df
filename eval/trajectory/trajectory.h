#pragma once

#include <vector>

#include "core/navigation_state.h"
#include "core/status.h"

namespace alidade {

/// One row of a trajectory file. Fields that the file does not contain stay zero; the flags of Trajectory
/// tell which it contains.
struct TrajectoryPoint {
  TimeNs stamp_ns = 0;
  NavState nav;
  ImuBias bias;
  Matrix6d covariance = Matrix6d::Zero();  ///< canonical chart (phi, dp)
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
