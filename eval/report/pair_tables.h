#pragma once

#include <string>
#include <vector>

#include "eval/comparison/paired.h"
#include "eval/report/text_table.h"

namespace alidade {

/// Prefix of the titles of these tables.
inline constexpr const char* kPairTitle = "Pairs: ";

/// One matrix a sequence and figure of Comparison::pair_figures: estimators down and across, row minus column
/// with half of the 95 % interval, the verdict on the row, the p-value and that corrected for the
/// number of pairs of the matrix. With Comparison::pair_across one matrix a
/// figure, over the sequences. A sequence with too few pairs gets none.
[[nodiscard]] std::vector<TextTable> LayOutPairTables(const Comparison& comparison,
                                                      const std::vector<Figure>& figures,
                                                      const std::string& plus_minus);

/// pairs.csv: every pair of every figure (docs/plans.md lists the columns).
[[nodiscard]] std::string PairsCsv(const Comparison& comparison, const std::vector<Figure>& figures);

}  // namespace alidade
