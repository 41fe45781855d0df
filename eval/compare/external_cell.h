#pragma once

#include <atomic>
#include <optional>
#include <string>

#include "core/measurement_log.h"
#include "eval/compare/external_run.h"
#include "eval/compare/plan.h"

namespace alidade {

/// One external estimator of a plan on one sequence and seed.
struct ExternalCell {
  const PlanEstimator& estimator;
  const PlanSequence& sequence;
  unsigned seed = 0;
  const MeasurementLog& log;
  const Trajectory* truth = nullptr;  ///< may be null
  std::string dataset_digest;
  std::string folder;  ///< of the cell: {output} of a command
};

struct ExternalOutcome {
  Trajectory trajectory;
  std::optional<ExternalRun> run;  ///< of a command
  bool reused = false;             ///< it had run before
};

/// Reads the cell's trajectory file, or runs its command and reads what it left. A command finds {dataset}
/// (the sequence's folder; that of a simulation is written), {bag} (the same as a bag, written when it is
/// asked for), {output}, {sequence} and {seed}. external.json beside the result says what ran on what and how
/// long; with `resume`, and unless either changed, it is not run again. Errors: those of RunExternal,
/// WriteBag and ReadExternalTrajectory; kOutput.
Result<ExternalOutcome> TrajectoryOfExternal(const ExternalCell& cell, bool resume,
                                             const std::atomic<bool>* stop);

}  // namespace alidade
