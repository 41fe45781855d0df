#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "eval/comparison/comparison.h"

namespace alidade {

/// Which values of a figure are better.
enum class Ideal {
  kNone,    ///< no value is better than another (features used, the shared front end's time, speed)
  kLow,     ///< errors, times
  kTarget,  ///< nearest to Figure::target: NEES to its degrees of freedom, coverage to the Gaussian share,
            ///< completion to 1
};

/// A column of summary.csv that is a number and is averaged over seeds.
struct Figure {
  std::string key;    ///< name of the column
  std::string label;  ///< display name, without the unit
  std::string unit;   ///< "m", "deg", "ms", "s/s", "" when dimensionless
  Ideal ideal = Ideal::kNone;
  double target = 0;  ///< with Ideal::kTarget
  int decimals = 3;   ///< in tables
  /// NaN where the cell has no such value: a failed run, or an external trajectory without covariance or
  /// times.
  std::function<double(const CellResult&)> value;
  /// Means and pairs are of all runs, however they ended, not only of those that ended ok.
  bool of_all_runs = false;
};

/// The figures of a comparison: the fixed ones, and position and orientation RPE of every distance that
/// occurs.
[[nodiscard]] std::vector<Figure> ListFigures(const Comparison& comparison);

/// Place of the figure `key` in the list; none when it is not there.
[[nodiscard]] std::optional<size_t> FindFigure(const std::vector<Figure>& figures, const std::string& key);

/// How far a value is from ideal; smaller is better, NaN without an ideal or a value.
[[nodiscard]] double Badness(const Figure& figure, double value);

}  // namespace alidade
