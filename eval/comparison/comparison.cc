#include "eval/comparison/comparison.h"

#include <algorithm>
#include <set>

namespace alidade {

std::string ModeWord(bool smoothed) {
  return smoothed ? "smoothed" : "causal";
}

std::vector<std::string> Comparison::SequencesWithTruthCovariance() const {
  std::set<std::string> names;
  for (const CellResult& cell : cells) {
    if (cell.truth_has_covariance) {
      names.insert(cell.sequence);
    }
  }
  return {names.begin(), names.end()};
}

std::vector<std::string> Comparison::SmoothedEstimators() const {
  std::vector<std::string> names;
  for (const CellResult& cell : cells) {
    if (cell.smoothed && std::find(names.begin(), names.end(), cell.estimator) == names.end()) {
      names.push_back(cell.estimator);
    }
  }
  return names;
}

}  // namespace alidade
