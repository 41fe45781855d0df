#include "eval/record/run_result.h"

#include "eval/trajectory/trajectory_point.h"

namespace alidade {

std::string StatusWord(const RunResult& result) {
  if (result.interrupted) {
    return "interrupted";
  }
  if (result.status.ok()) {
    return "ok";
  }
  if (result.status.code() != StatusCode::kDiverged) {
    return "failed";
  }
  return result.init_method.empty() ? "not_initialized" : "diverged";
}

Trajectory TrajectoryOf(const RunResult& result) {
  Trajectory trajectory;
  trajectory.has_velocity = trajectory.has_bias = trajectory.has_covariance = true;
  trajectory.points.reserve(result.records.size());
  for (const RunRecord& record : result.records) {
    trajectory.points.push_back(PointOf(record.estimate));
  }
  return trajectory;
}

}  // namespace alidade
