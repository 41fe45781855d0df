#pragma once

#include <functional>
#include <string>

#include "core/estimator_config.h"
#include "eval/compare/compare_input.h"
#include "eval/compare/compare_options.h"
#include "eval/compare/plan.h"
#include "eval/comparison/comparison.h"

namespace alidade {

/// One estimator on one sequence with one seed.
struct CompareCell {
  const PlanEstimator* estimator = nullptr;
  const EstimatorConfig* config = nullptr;  ///< null when external
  const PlanSequence* sequence = nullptr;
  CompareInput* input = nullptr;
  unsigned seed = 0;
  std::string folder;       ///< of its outputs
  std::string report_file;  ///< of its CellReport (eval/comparison/cell_file.h)
  std::string digest;       ///< of its CellReport
  CellResult result;
};

/// Gets the input, runs the estimator (or keeps the existing result when resuming), writes its folder and
/// fills `cell->result`, whose status and message describe a failure; an exception of a library is a failed
/// cell. `on_input` receives the cell's input. Returns true when the existing result was kept.
bool RunCompareCell(const Plan& plan, const CompareOptions& options, const PipelineOptions& pipeline,
                    const std::function<void(const CompareInput::Data&)>& on_input, CompareCell* cell);

}  // namespace alidade
