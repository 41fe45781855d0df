#pragma once

#include <functional>
#include <string>

#include "core/status.h"
#include "eval/trajectory/trajectory.h"

namespace alidade {

/// Reads a trajectory; the format is recognised by its header and extension: EuRoC 17 columns, EuRoC 8
/// columns (`data_pose.csv`), the first four of them (`data_position.csv`: no orientation), our `states.csv`,
/// TUM (`.tum`, `.txt`: 8 space-separated columns, x y z qx qy qz qw). Quaternions are normalised after
/// reading (public truth rounds them to six digits); a norm off by more than 1e-2 is an error. Covariances
/// are read from states.csv, or from a file beside a truth file (truth_covariance.h). Errors (kInput) name
/// file and line: missing file, torn row, non-finite number, stamps out of order.
Result<Trajectory> ReadTrajectory(const std::string& path);
/// The same row by row: `take` is handed each point, and the answer holds none. Covariances beside the file
/// are not read.
Result<Trajectory> ReadTrajectory(const std::string& path,
                                  const std::function<void(const TrajectoryPoint&)>& take);

}  // namespace alidade
