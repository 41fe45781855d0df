#pragma once

#include <string>
#include <vector>

#include "eval/study/fault_recovery.h"

namespace alidade {

/// One estimator on one sequence with a fault, over its seeds.
struct FaultStudyRow {
  std::string sequence;
  std::string estimator;
  std::vector<FaultFigures> runs;
};

/// Markdown: of each event, mean and worst time of the runs in which it happened, and how many those are if
/// not all. A row without runs is omitted.
[[nodiscard]] std::string FaultStudyTable(const std::vector<FaultStudyRow>& rows);

}  // namespace alidade
