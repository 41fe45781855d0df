#pragma once

#include <string>

#include "core/status.h"
#include "eval/comparison/comparison.h"

namespace alidade {

/// Writes summary.csv, aggregate.csv, pairs.csv, nees_over_time.csv, tables.md, tables.tex and report.json
/// into `folder` (docs/plans.md). Errors: kOutput.
Status WriteTables(const Comparison& comparison, const std::string& folder);

}  // namespace alidade
