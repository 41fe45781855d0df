#pragma once

#include <string>
#include <vector>

#include "eval/comparison/comparison.h"
#include "eval/report/text_table.h"

namespace alidade {

/// One overview each for position and orientation ATE (estimators down, sequences across; only with several
/// sequences), then one table a sequence with its figures across, then efficiencies
/// (eval/report/efficiency_tables.h) and paired differences (eval/report/pair_tables.h). Reference figures
/// follow the estimators.
[[nodiscard]] std::vector<TextTable> LayOutTables(const Comparison& comparison,
                                                  const std::string& plus_minus);

}  // namespace alidade
