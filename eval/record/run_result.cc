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

size_t RecordCount(const RunResult& result) {
  return (result.spool == nullptr ? 0 : result.spool->records().size()) + result.records.size();
}

const RunRecord* FirstRecord(const RunResult& result) {
  if (result.spool != nullptr && !result.spool->records().empty()) {
    return &result.spool->records().front();
  }
  return result.records.empty() ? nullptr : &result.records.front();
}

Status ForEachRecord(const RunResult& result, const std::function<Status(const RunRecord&)>& take) {
  if (result.spool != nullptr) {
    Table<RunRecord>::Pass pass(result.spool->records());
    while (true) {
      const Result<const RunRecord*> record = pass.Next();
      ALIDADE_RETURN_IF_ERROR(record.status());
      if (*record == nullptr) {
        break;
      }
      ALIDADE_RETURN_IF_ERROR(take(**record));
    }
  }
  for (const RunRecord& record : result.records) {
    ALIDADE_RETURN_IF_ERROR(take(record));
  }
  return Status::Ok();
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
