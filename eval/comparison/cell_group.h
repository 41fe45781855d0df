#pragma once

#include <string>
#include <vector>

#include "eval/comparison/comparison.h"

namespace alidade {

/// The cells of one aggregate row.
struct CellGroup {
  std::string label;
  std::string sequence;
  std::vector<const CellResult*> cells;
};
/// By sequence, then label, both in order of first appearance; they point into `comparison`.
[[nodiscard]] std::vector<CellGroup> GroupCells(const Comparison& comparison);

/// The labels of the cells' aggregate rows: the estimator, with its backend where it has several.
[[nodiscard]] std::vector<std::string> LabelsOf(const Comparison& comparison);

}  // namespace alidade
