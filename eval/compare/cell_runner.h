#pragma once

#include <string>

#include "eval/compare/cell_list.h"
#include "eval/comparison/cell_file.h"

namespace alidade {

/// Writes the report of a cell whose process has ended without one: failed, and why. Errors: kOutput.
Status ReportFault(const CompareCell& cell, const std::string& fault);

/// Runs cells one after the other in this process. The input of the last one is kept: runs of cells of one
/// input load it once.
class CellRunner {
 public:
  /// All must outlive the object.
  CellRunner(const Plan& plan, const CompareOptions& options, CellList* cells);
  ~CellRunner();
  CellRunner(const CellRunner&) = delete;
  CellRunner& operator=(const CellRunner&) = delete;

  /// Runs the cell and writes its report_file; an interrupted one leaves none. Errors: kOutput.
  Status Run(size_t cell);
  /// Only loads its input, so that the front end's output is kept for others.
  Status Prepare(size_t cell);

 private:
  void Hold(CompareInput* input);

  const Plan& plan_;
  const CompareOptions& options_;
  CellList* const cells_;
  PipelineOptions pipeline_;
  CompareInput* held_ = nullptr;
};

}  // namespace alidade
