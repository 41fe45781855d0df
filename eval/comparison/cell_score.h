#pragma once

#include "eval/comparison/comparison.h"
#include "eval/metrics/evaluate.h"
#include "eval/record/run_result.h"

namespace alidade {

/// Fills the figures and the series of `cell` from an estimate and the truth. `truth` null: figures stay
/// unknown and the message gives the reason. Too few common stamps: status "failed" with the reason.
void ScoreTrajectory(const Trajectory* truth, const Trajectory& estimate, const EvaluationOptions& options,
                     CellResult* cell);

/// Fills the times of `cell` from those of its frames [ms]; a front end without any is unknown.
void ScoreTimes(const std::vector<double>& frontend_ms, const std::vector<double>& backend_ms,
                CellResult* cell);

/// ScoreTrajectory, and status, frames, times and features of the run.
void ScoreRun(const Trajectory* truth, const RunResult& run, const EvaluationOptions& options,
              CellResult* cell);

}  // namespace alidade
