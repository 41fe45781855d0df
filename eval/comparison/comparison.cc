#include "eval/comparison/comparison.h"

#include <set>

namespace alidade {

std::vector<std::string> Comparison::SequencesWithTruthCovariance() const {
  std::set<std::string> names;
  for (const CellResult& cell : cells) {
    if (cell.truth_has_covariance) {
      names.insert(cell.sequence);
    }
  }
  return {names.begin(), names.end()};
}

}  // namespace alidade
