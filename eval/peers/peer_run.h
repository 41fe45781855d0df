#pragma once

#include <string>
#include <vector>

#include "core/status.h"
#include "eval/trajectory/trajectory.h"

namespace alidade {

/// CPU time of a frame, of all threads [ms].
struct PeerTimes {
  double frontend_ms = 0;  ///< 0 where tracks were given
  double backend_ms = 0;
};

/// What a driver writes of a run: one entry a frame for which the other system has a state.
struct PeerRun {
  Trajectory trajectory;         ///< stamps in IMU time
  std::vector<PeerTimes> times;  ///< of the same frames

  /// Takes a frame's state; `total_s`: of front end and back end [s].
  void Add(const TrajectoryPoint& point, double frontend_s, double total_s) {
    trajectory.points.push_back(point);
    times.push_back({1e3 * frontend_s, 1e3 * (total_s - frontend_s)});
  }
};

/// Writes trajectory.csv (EuRoC's columns, as far as the trajectory has them), trajectory_covariance.csv
/// where there are covariances, and timing.csv (`timestamp_ns,frontend_ms,backend_ms`) into `folder`. The
/// first is what `result` of a plan names. Errors: kDiverged: no frame has a state; kOutput.
Status WritePeerRun(const PeerRun& run, const std::string& folder);

/// What is left of main() in a driver: runs `execute` with the arguments and prints its error after `name`.
/// Returns the exit code, 0 or 1.
int RunDriver(const char* name, int argc, char** argv,
              Status (*execute)(const std::vector<std::string>& arguments));

}  // namespace alidade
