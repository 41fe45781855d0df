#include "eval/comparison/cell_group.h"

#include <utility>

#include "eval/comparison/distinct.h"

namespace alidade {

std::string LabelOf(const Comparison& comparison, const CellResult& cell) {
  for (const CellResult& other : comparison.cells) {
    const bool both_known = !other.backend.empty() && !cell.backend.empty();
    if (other.estimator == cell.estimator && both_known && other.backend != cell.backend) {
      return cell.estimator + " (" + cell.backend + ")";
    }
  }
  return cell.estimator;
}

std::vector<CellGroup> GroupCells(const Comparison& comparison) {
  std::vector<std::string> of_cell;  // a label costs a walk over all cells: once each
  for (const CellResult& cell : comparison.cells) {
    of_cell.push_back(LabelOf(comparison, cell));
  }
  const std::vector<std::string> labels = Distinct(of_cell, [](const std::string& label) { return label; });
  const std::vector<std::string> sequences =
      Distinct(comparison.cells, [](const CellResult& cell) { return cell.sequence; });
  std::vector<CellGroup> groups;
  for (const std::string& sequence : sequences) {
    for (const std::string& label : labels) {
      CellGroup group{label, sequence, {}};
      for (size_t i = 0; i < of_cell.size(); ++i) {
        if (of_cell[i] == label && comparison.cells[i].sequence == sequence) {
          group.cells.push_back(&comparison.cells[i]);
        }
      }
      if (!group.cells.empty()) {
        groups.push_back(std::move(group));
      }
    }
  }
  return groups;
}

}  // namespace alidade
