#pragma once

#include <string>
#include <utility>
#include <vector>

#include "eval/comparison/comparison.h"

namespace alidade {

/// The pose NEES averaged over the runs of one estimator on one sequence, instant by instant: runs are
/// independent, so that at each instant the average over N runs of a consistent estimator is chi-square with
/// 6 N degrees of freedom, over N (Bar-Shalom, Li, Kirubarajan 2001, sec. 5.4). All vectors have one entry an
/// instant.
struct NeesOverTime {
  std::vector<double> time_s;  ///< since the run's first pair
  std::vector<double> mean;
  std::vector<int> runs;                        ///< how many of them are averaged
  std::vector<std::pair<double, double>> band;  ///< 95 %, of that many runs
  double share_inside = 0;                      ///< of the instants; NaN without any. Consistent: 0.95
};

/// Averages the runs that ended ok. The grid is that of the longest of them; another run counts at an
/// instant when it has a value within half a grid step. Runs without covariance do not count.
[[nodiscard]] NeesOverTime AverageNees(const std::vector<const CellResult*>& cells);

/// The same of every estimator on every sequence, by sequence, in order of first appearance.
struct NeesCurve {
  std::string label;
  std::string sequence;
  NeesOverTime average;
};
[[nodiscard]] std::vector<NeesCurve> AverageNees(const Comparison& comparison);

/// Whether the mean NEES over runs fits its band: "consistent", "overconfident" (above it: the errors are
/// larger than claimed) or "cautious" (below it); empty without a value.
[[nodiscard]] std::string NeesVerdict(double mean, const std::pair<double, double>& band);

}  // namespace alidade
