#include "eval/comparison/large_comparison.h"

#include <algorithm>
#include <vector>

#include "eval/comparison/series_rows.h"

namespace alidade {
namespace {

/// What the mean NEES over time needs of a series: its evenly spaced rows.
CellSeries NeesAlone(const CellSeries& series) {
  CellSeries kept;
  for (size_t i = 0; i < std::min(series.time_s.size(), series.nees_pose.size()); ++i) {
    if (series.regular.empty() || series.regular[i]) {
      kept.time_s.push_back(series.time_s[i]);
      kept.nees_pose.push_back(series.nees_pose[i]);
    }
  }
  kept.time_s.shrink_to_fit();
  kept.nees_pose.shrink_to_fit();
  return kept;
}

}  // namespace

ShownCells::ShownCells(const std::vector<size_t>& group, size_t groups) {
  if (group.size() <= kMostShown) {
    return;
  }
  const size_t most_a_group = std::max<size_t>(1, kMostShown / groups);
  std::vector<size_t> taken(groups);
  size_t all = 0;
  for (const size_t of : group) {
    shown_.push_back(all < kMostShown && taken[of] < most_a_group);
    taken[of] += shown_.back() ? 1 : 0;
    all += shown_.back() ? 1 : 0;
  }
}

void ShownCells::Thin(size_t index, CellResult* cell) const {
  if (shown_.empty()) {
    return;
  }
  cell->shown = shown_[index] || cell->status != "ok";
  cell->series = TakeRows(cell->series, PickRows(cell->series, kPoints));
  if (!cell->shown) {
    cell->series = NeesAlone(cell->series);
    cell->sky = {};
    for (RpeResult& rpe : cell->rpe) {
      rpe.pos_errors_m = {};
    }
  }
}

std::string ShownCells::note() const {
  return shown_.empty() ? ""
                        : "Curves and single runs: of the first " +
                              std::to_string(std::count(shown_.begin(), shown_.end(), true)) + " of " +
                              std::to_string(shown_.size()) +
                              " runs and of those that failed. All runs are in the means and in summary.csv.";
}

}  // namespace alidade
