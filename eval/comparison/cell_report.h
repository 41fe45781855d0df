#pragma once

#include <optional>
#include <string>
#include <vector>

#include "eval/comparison/comparison.h"

namespace alidade {

/// What a cell leaves for the tables, which another process or another machine may write.
struct CellReport {
  CellResult result;
  /// Of all settings of the cell in the plan: a report of another digest is of another comparison.
  std::string digest;
  bool reused = false;                      ///< an earlier run was kept
  std::optional<FrontendSummary> frontend;  ///< of its input, where images were tracked
  std::vector<std::string> remarks;         ///< of the reader of its input
};

}  // namespace alidade
