#include "eval/compare/compare_cell.h"

#include <algorithm>
#include <exception>
#include <numeric>

#include "eval/compare/external_cell.h"
#include "eval/comparison/cell_progress.h"
#include "eval/comparison/cell_score.h"
#include "eval/dataset/digest.h"
#include "eval/metrics/completion.h"
#include "eval/record/recorder.h"
#include "eval/record/recorder_reader.h"
#include "eval/record/run_options.h"
#include "eval/record/runner.h"
#include "eval/record/truth_start.h"

namespace alidade {
namespace {

void Fail(const std::string& message, CompareCell* cell) {
  cell->result.status = "failed";
  cell->result.message = message;
}

/// Times of a program that ran; without its own they are those of the whole program: it is one process to us.
void ScoreExternalTimes(const ExternalOutcome& outcome, const std::vector<TrackFrame>& frames,
                        CellResult* cell) {
  if (outcome.times) {
    const ExternalTimes& times = *outcome.times;
    ScoreTimes(times.frontend_ms, times.backend_ms, cell);
    double run_ms = 0;
    for (const std::vector<double>* part : {&times.frontend_ms, &times.backend_ms}) {
      run_ms = std::accumulate(part->begin(), part->end(), run_ms);
    }
    const bool stamped = !times.stamps_ns.empty();
    ScoreSpeed(CoveredSeconds(stamped ? times.stamps_ns : RowStamps(outcome.trajectory)), 1e-3 * run_ms,
               cell);
  } else if (outcome.run) {
    cell->backend_ms = 1e3 * outcome.run->wall_s / std::max(1, cell->frames);
    const bool camera = !frames.empty();
    ScoreSpeed(camera ? SecondsBetween(frames.front().stamp_ns, frames.back().stamp_ns) : 0,
               outcome.run->wall_s, cell);
  }
}

/// A program or trajectories that are not ours. True: the program's earlier output was kept.
bool RunExternalCell(const Plan& plan, const CompareOptions& options, const CompareInput::Data& data,
                     CompareCell* cell) {
  const Trajectory* truth = data.truth ? &*data.truth : nullptr;
  const ExternalCell external{*cell->estimator,    *cell->sequence, cell->seed, data.log, truth,
                              data.dataset_digest, cell->folder};
  const Result<ExternalOutcome> outcome = TrajectoryOfExternal(external, options.resume, options.stop);
  if (!outcome.ok()) {
    Fail(outcome.message(), cell);
    return false;
  }
  ScoreTrajectory(truth, outcome->trajectory, plan.MetricsOf(*cell->estimator, *cell->sequence),
                  &cell->result);
  ScoreCompletion(RowStamps(outcome->trajectory), data.log.frames, data.log.rig.camera_time_offset_s,
                  &cell->result);
  ScoreExternalTimes(*outcome, data.log.frames, &cell->result);
  return outcome->reused;
}

/// Writes a run of `identity` into the cell's folder.
Status RunAndWrite(const RunIdentity& identity, const CompareInput::Data& data, const CompareOptions& options,
                   const CompareCell& cell) {
  RunOptions run_options;
  run_options.truth = data.truth ? &*data.truth : nullptr;
  run_options.true_rig = data.true_rig ? &*data.true_rig : nullptr;
  run_options.seed = cell.seed;
  run_options.stop = options.stop;
  run_options.audit = identity.audited;
  const RunResult result = RunEstimator(*cell.config, data.log, run_options);
  return result.interrupted ? Status::Input("interrupted") : WriteRun(identity, result, cell.folder);
}

bool RunOwn(const Plan& plan, const CompareOptions& options, const CompareInput::Data& data,
            CompareCell* cell) {
  const RunIdentity identity{*cell->config,
                             cell->sequence->name,
                             data.dataset_digest,
                             data.input_digest,
                             cell->seed,
                             data.log.imu.size(),
                             data.log.frames.size(),
                             plan.audit && cell->config->backend == Backend::kFilter,
                             DigestOfStartTruth(cell->config->init, data.truth ? &*data.truth : nullptr)};
  const bool kept = options.resume && HoldsRun(cell->folder, identity);
  if (!kept) {
    if (const Status status = RunAndWrite(identity, data, options, *cell); !status.ok()) {
      Fail(status.message(), cell);
      return false;
    }
  }
  // Scored from what was written: fresh and resumed comparisons give the same figures to the last digit.
  const Result<RunResult> written = ReadRun(cell->folder);
  if (written.ok()) {
    ScoreRun(data.truth ? &*data.truth : nullptr, *written, plan.MetricsOf(*cell->estimator, *cell->sequence),
             &cell->result);
    ScoreProgress(written->records, data.log.frames, data.log.rig.camera_time_offset_s, &cell->result);
  } else {
    Fail(written.message(), cell);
  }
  return kept;
}

bool Run(const Plan& plan, const CompareOptions& options, const PipelineOptions& pipeline,
         const std::function<void(const CompareInput::Data&)>& on_input, CompareCell* cell) {
  const Result<CompareInput::Data>& data = cell->input->Acquire(pipeline);
  if (!data.ok()) {
    Fail(data.message(), cell);
    return false;
  }
  on_input(*data);
  cell->result.input_digest = DigestOf(data->log);
  if (cell->result.input_digest != data->input_digest) {
    Fail("the measurement log changed between two estimators", cell);
    return false;
  }
  return cell->config == nullptr ? RunExternalCell(plan, options, *data, cell)
                                 : RunOwn(plan, options, *data, cell);
}

}  // namespace

bool RunCompareCell(const Plan& plan, const CompareOptions& options, const PipelineOptions& pipeline,
                    const std::function<void(const CompareInput::Data&)>& on_input, CompareCell* cell) {
  try {
    return Run(plan, options, pipeline, on_input, cell);
  } catch (const std::exception& error) {
    Fail(error.what(), cell);
    return false;
  }
}

}  // namespace alidade
