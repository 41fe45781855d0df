#include "eval/metrics/tool_association.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace alidade {
namespace {

std::vector<double> StampsOf(const Trajectory& trajectory) {
  std::vector<double> stamps;
  stamps.reserve(trajectory.points.size());
  for (const TrajectoryPoint& point : trajectory.points) {
    stamps.push_back(ToDoubleSeconds(point.stamp_ns));
  }
  return stamps;
}

/// Index of the nearest of `stamps`, the first of equally near ones. Precondition: sorted, not empty.
std::size_t Nearest(const std::vector<double>& stamps, double stamp) {
  std::size_t best =
      static_cast<std::size_t>(std::lower_bound(stamps.begin(), stamps.end(), stamp) - stamps.begin());
  best = std::min(best, stamps.size() - 1);
  while (best > 0 && std::abs(stamps[best - 1] - stamp) <= std::abs(stamps[best] - stamp)) {
    --best;
  }
  return best;
}

}  // namespace

double ToDoubleSeconds(TimeNs stamp_ns) {
  // A long double holds all 63 bits of the stamp.
  return static_cast<double>(static_cast<long double>(stamp_ns) / 1e9L);
}

std::vector<RowPair> MatchAsEvo(const Trajectory& truth, const Trajectory& estimate, double max_dt_s) {
  const bool estimate_is_longer = estimate.points.size() > truth.points.size();
  const std::vector<double> brief = StampsOf(estimate_is_longer ? truth : estimate);
  const std::vector<double> full = StampsOf(estimate_is_longer ? estimate : truth);
  std::vector<RowPair> matches;
  for (std::size_t i = 0; i < brief.size() && !full.empty(); ++i) {
    const std::size_t nearest = Nearest(full, brief[i]);
    if (std::abs(full[nearest] - brief[i]) <= max_dt_s) {
      matches.push_back(estimate_is_longer ? RowPair(i, nearest) : RowPair(nearest, i));
    }
  }
  return matches;
}

std::vector<RowPair> MatchAsRpg(const Trajectory& truth, const Trajectory& estimate, double max_dt_s) {
  const std::vector<double> truth_stamps = StampsOf(truth);
  const std::vector<double> estimate_stamps = StampsOf(estimate);
  // Distance, estimate, truth: equal distances are decided by the rows, as in the tool.
  std::vector<std::tuple<double, std::size_t, std::size_t>> candidates;
  for (std::size_t e = 0; e < estimate_stamps.size(); ++e) {
    // The margin keeps the rounding of the bound from excluding a row; the distance decides.
    const double margin = max_dt_s + 1e-3;
    std::size_t t = static_cast<std::size_t>(
        std::lower_bound(truth_stamps.begin(), truth_stamps.end(), estimate_stamps[e] - margin) -
        truth_stamps.begin());
    for (; t < truth_stamps.size() && truth_stamps[t] <= estimate_stamps[e] + margin; ++t) {
      const double distance = std::abs(estimate_stamps[e] - truth_stamps[t]);
      if (distance < max_dt_s) {
        candidates.emplace_back(distance, e, t);
      }
    }
  }
  std::sort(candidates.begin(), candidates.end());
  std::vector<bool> truth_taken(truth_stamps.size(), false);
  std::vector<bool> estimate_taken(estimate_stamps.size(), false);
  std::vector<RowPair> matches;
  for (const auto& [distance, e, t] : candidates) {
    if (!truth_taken[t] && !estimate_taken[e]) {
      truth_taken[t] = true;
      estimate_taken[e] = true;
      matches.emplace_back(t, e);
    }
  }
  std::sort(matches.begin(), matches.end(),
            [](const RowPair& a, const RowPair& b) { return a.second < b.second; });
  return matches;
}

}  // namespace alidade
