#pragma once

#include "eval/compare/compare_options.h"
#include "eval/compare/plan.h"
#include "eval/comparison/comparison.h"

namespace alidade {

struct CompareOutcome {
  Comparison comparison;
  int cells_failed = 0;  ///< whose status is not ok
  int cells_reused = 0;
  bool interrupted = false;  ///< then no tables were written; complete cells are kept for resume
};

/// Runs every estimator on every sequence and seed. All estimators read one measurement log a sequence and
/// seed (the front end runs once); its digest is computed again for each cell. Cells run in processes of
/// their own (WorkerPool) or as jobs of Slurm (SlurmRun). Writes cells/<estimator>/<sequence>/<seed>/, the
/// reports of the cells below scores/, and the tables and the report of eval/comparison/comparison.h. A cell
/// that fails or whose process dies does not stop the others. Errors: kConfig of an estimator's or a
/// simulation's configuration and kUsage of SOURCE_DATE_EPOCH (eval/files/utc_day.h), before anything runs;
/// kOutput.
Result<CompareOutcome> Compare(const Plan& plan, const CompareOptions& options);

/// The `part` of the cells of a comparison that has begun elsewhere, in options.jobs worker processes; those
/// whose report is there are passed over, unless it is of another plan or configuration (CellReport::digest).
Status RunCells(const Plan& plan, const CompareOptions& options, const CellPart& part);

/// Tracks the images of the inputs of these cells, in this process, each within options.limits.time_s.
Status TrackInputs(const Plan& plan, const CompareOptions& options, const CellPart& part);

/// The tables of a comparison whose cells have run elsewhere; a cell without a report of this plan
/// has failed.
Result<CompareOutcome> CollectCells(const Plan& plan, const CompareOptions& options);

}  // namespace alidade
