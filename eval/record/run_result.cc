#include "eval/record/run_result.h"

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
    const NavEstimate& estimate = record.estimate;
    trajectory.points.push_back(
        {estimate.stamp_ns,
         estimate.nav,
         estimate.bias,
         estimate.covariance.topLeftCorner<6, 6>(),
         {estimate.covariance.block<3, 3>(6, 6), estimate.covariance.block<3, 3>(9, 9),
          estimate.covariance.block<3, 3>(12, 12)}});
  }
  return trajectory;
}

}  // namespace alidade
