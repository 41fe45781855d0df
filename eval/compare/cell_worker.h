#pragma once

#include "eval/compare/compare_options.h"
#include "eval/compare/plan.h"

namespace alidade {

/// A worker of a comparison (WorkerPool): writes "ready", then runs the cell whose number it reads from
/// standard input, line by line, and writes "done <number>" when its report is written. Ends with its input,
/// and when the process that started it ends. Errors: kConfig; kOutput: a report cannot be written.
Status ServeCells(const Plan& plan, const CompareOptions& options);

}  // namespace alidade
