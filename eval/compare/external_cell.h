#pragma once

#include <atomic>
#include <optional>
#include <string>

#include "core/estimator/measurement_log.h"
#include "eval/compare/external_run.h"
#include "eval/compare/external_times.h"
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
  std::optional<ExternalRun> run;      ///< of a command
  std::optional<ExternalTimes> times;  ///< of a command that wrote timing.csv into {output}
  bool reused = false;                 ///< kept from an earlier run
};

/// Reads the cell's trajectory file, or runs its command and reads the result. Placeholders of a command:
/// {dataset} (the sequence's folder; for a simulation it is written), {bag} (the same as a bag, written on
/// request), {output}, {program}, {sequence} and {seed}. external.json beside the result records command,
/// input and times of a run that succeeded; with `resume` it is not run again while the filled command, the
/// name of the result and the digest of the input are the same, wherever the folders stand now. Errors: those
/// of RunExternal, WriteBag and ReadExternalTrajectory; kOutput.
Result<ExternalOutcome> TrajectoryOfExternal(const ExternalCell& cell, bool resume,
                                             const std::atomic<bool>* stop);

}  // namespace alidade
