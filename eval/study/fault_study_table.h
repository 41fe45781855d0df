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

/// Markdown: mean and worst of the times of the runs that have recovered, and how many of all those are. A
/// row without runs is omitted.
[[nodiscard]] std::string FaultStudyTable(const std::vector<FaultStudyRow>& rows);

}  // namespace alidade
