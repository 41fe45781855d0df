#pragma once

#include <string>

#include "core/status.h"
#include "eval/comparison/comparison.h"

namespace alidade {

/// Writes the report (docs/report.md), one self-contained HTML file. Errors: kOutput.
Status WriteReport(const Comparison& comparison, const std::string& path);

}  // namespace alidade
