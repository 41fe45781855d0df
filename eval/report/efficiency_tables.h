#pragma once

#include <vector>

#include "eval/report/text_table.h"

namespace alidade {

/// Prefix of the titles of these tables.
inline constexpr const char* kEfficiencyTitle = "Efficiency: ";

/// ComputeEfficiency as tables, one a sequence; none without a batch.
[[nodiscard]] std::vector<TextTable> LayOutEfficiencyTables(const Comparison& comparison);

}  // namespace alidade
