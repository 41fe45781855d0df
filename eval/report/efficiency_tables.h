#pragma once

#include <vector>

#include "eval/report/table_layout.h"

namespace alidade {

/// What the titles of these tables start with.
inline constexpr const char* kEfficiencyTitle = "Efficiency: ";

/// ComputeEfficiency as tables, one a sequence; none without a batch.
[[nodiscard]] std::vector<TextTable> LayOutEfficiencyTables(const Comparison& comparison);

}  // namespace alidade
