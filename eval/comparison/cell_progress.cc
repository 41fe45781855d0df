#include "eval/comparison/cell_progress.h"

#include "eval/metrics/completion.h"

namespace alidade {

void ScoreCompletion(const std::vector<TimeNs>& rows_ns, const std::vector<TrackFrame>& frames,
                     double camera_time_offset_s, CellResult* cell) {
  if (!frames.empty()) {
    const TimeNs offset_ns = SecondsToNs(camera_time_offset_s);
    cell->completion =
        Completion(rows_ns, frames.front().stamp_ns + offset_ns, frames.back().stamp_ns + offset_ns);
  }
}

void ScoreSpeed(double data_s, double run_s, CellResult* cell) {
  if (data_s > 0 && run_s > 0) {
    cell->realtime_factor = data_s / run_s;
  }
}

void ScoreProgress(const std::vector<RunRecord>& records, const std::vector<TrackFrame>& frames,
                   double camera_time_offset_s, CellResult* cell) {
  std::vector<TimeNs> rows_ns;
  double run_ms = 0;
  for (const RunRecord& record : records) {
    rows_ns.push_back(record.estimate.stamp_ns);
    run_ms += record.frontend_ms + record.backend_ms;
  }
  ScoreCompletion(rows_ns, frames, camera_time_offset_s, cell);
  ScoreSpeed(CoveredSeconds(rows_ns), 1e-3 * run_ms, cell);
}

}  // namespace alidade
