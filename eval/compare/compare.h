#pragma once

#include <atomic>
#include <functional>
#include <string>

#include "eval/compare/plan.h"
#include "eval/comparison/comparison.h"
#include "eval/report/figure_files.h"

namespace alidade {

struct CompareOptions {
  std::string output;
  int jobs = 1;  ///< runs at a time; results do not depend on it, but their times do
  /// Keep the cells that are complete and were made from the same input and configuration.
  bool resume = false;
  FigureFormats figures;  ///< for papers, into figures/
  std::string command;    ///< command line that repeats it, for the report
  const std::atomic<bool>* stop = nullptr;
  std::function<void(const std::string& line)> progress;  ///< called by one thread at a time
};

struct CompareOutcome {
  Comparison comparison;
  int cells_failed = 0;  ///< whose status is not ok
  int cells_reused = 0;
  bool interrupted = false;  ///< then no tables were written; complete cells are kept for resume
};

/// Runs every estimator on every sequence and seed. All estimators read one measurement log a sequence and
/// seed (the front end runs once); its digest is computed again for each cell. Writes
/// cells/<estimator>/<sequence>/<seed>/ and the tables and the report of eval/comparison/comparison.h. A cell
/// that fails does not stop the others. Errors: kConfig of an estimator's or a simulation's configuration,
/// before anything runs; kOutput.
Result<CompareOutcome> Compare(const Plan& plan, const CompareOptions& options);

}  // namespace alidade
