#pragma once

#include <optional>
#include <string>

#include "core/status.h"
#include "eval/record/run_result.h"

namespace alidade::cli {

/// A run of the comparison in --input; empty: it is not there, as of an interrupted comparison.
Result<std::optional<RunResult>> StoredRun(const std::string& estimator, const std::string& sequence,
                                           unsigned seed);

}  // namespace alidade::cli
