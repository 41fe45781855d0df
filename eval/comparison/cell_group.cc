#include "eval/comparison/cell_group.h"

#include <map>
#include <set>
#include <utility>

namespace alidade {

std::vector<std::string> LabelsOf(const Comparison& comparison) {
  std::map<std::string, std::set<std::string>> backends;
  for (const CellResult& cell : comparison.cells) {
    if (!cell.backend.empty()) {
      backends[cell.estimator].insert(cell.backend);
    }
  }
  std::vector<std::string> labels;
  for (const CellResult& cell : comparison.cells) {
    const bool several = !cell.backend.empty() && backends.at(cell.estimator).size() > 1;
    labels.push_back(several ? cell.estimator + " (" + cell.backend + ")" : cell.estimator);
  }
  return labels;
}

std::vector<CellGroup> GroupCells(const Comparison& comparison) {
  const std::vector<std::string> labels = LabelsOf(comparison);
  std::map<std::string, size_t> sequence_rank, label_rank;
  std::map<std::pair<size_t, size_t>, CellGroup> by_rank;
  for (size_t i = 0; i < labels.size(); ++i) {
    const CellResult& cell = comparison.cells[i];
    const size_t sequence = sequence_rank.try_emplace(cell.sequence, sequence_rank.size()).first->second;
    const size_t label = label_rank.try_emplace(labels[i], label_rank.size()).first->second;
    CellGroup& group = by_rank[{sequence, label}];
    group.label = labels[i];
    group.sequence = cell.sequence;
    group.cells.push_back(&cell);
  }
  std::vector<CellGroup> groups;
  groups.reserve(by_rank.size());
  for (auto& [rank, group] : by_rank) {
    groups.push_back(std::move(group));
  }
  return groups;
}

}  // namespace alidade
