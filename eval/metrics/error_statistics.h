#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

namespace alidade {

/// The figures that evo prints of a list of errors, in the unit of the errors (sse: in its square). NaN, and
/// sse 0, without errors.
struct ErrorStatistics {
  std::size_t count = 0;
  double rmse = std::numeric_limits<double>::quiet_NaN();
  double mean = std::numeric_limits<double>::quiet_NaN();
  double median = std::numeric_limits<double>::quiet_NaN();  ///< mean of the middle two of an even number
  double std = std::numeric_limits<double>::quiet_NaN();     ///< divided by the count, not by one less
  double min = std::numeric_limits<double>::quiet_NaN();
  double max = std::numeric_limits<double>::quiet_NaN();
  double sse = 0;  ///< sum of the squares
};
[[nodiscard]] ErrorStatistics ComputeErrorStatistics(std::vector<double> errors);

/// Nearest-rank percentile, `share` of 0 to 1; nothing without values.
[[nodiscard]] std::optional<double> Percentile(std::vector<double> values, double share);

}  // namespace alidade
