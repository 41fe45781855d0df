#pragma once

#include <string>
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

/// Reads a trajectory; the format is recognised by its header and extension: EuRoC 17 columns, EuRoC 8
/// columns (`data_pose.csv`), the first four of them (`data_position.csv`: no orientation), our `states.csv`,
/// TUM (`.tum`, `.txt`: 8 space-separated columns, x y z qx qy qz qw). Quaternions are normalised after
/// reading (public truth rounds them to six digits); a norm off by more than 1e-2 is an error. Errors
/// (kInput) name file and line: missing file, torn row, non-finite number, stamps out of order.
Result<Trajectory> ReadTrajectory(const std::string& path);

}  // namespace alidade
