#include "eval/metrics/error_statistics.h"

#include <algorithm>
#include <cmath>

namespace alidade {

ErrorStatistics ComputeErrorStatistics(std::vector<double> errors) {
  ErrorStatistics statistics;
  statistics.count = errors.size();
  if (errors.empty()) {
    return statistics;
  }
  std::sort(errors.begin(), errors.end());
  const double count = static_cast<double>(errors.size());
  double sum = 0;
  for (const double error : errors) {
    sum += error;
    statistics.sse += error * error;
  }
  statistics.mean = sum / count;
  statistics.rmse = std::sqrt(statistics.sse / count);
  double spread = 0;
  for (const double error : errors) {
    spread += (error - statistics.mean) * (error - statistics.mean);
  }
  statistics.std = std::sqrt(spread / count);
  const std::size_t middle = errors.size() / 2;
  statistics.median = errors.size() % 2 == 1 ? errors[middle] : 0.5 * (errors[middle - 1] + errors[middle]);
  statistics.min = errors.front();
  statistics.max = errors.back();
  return statistics;
}

std::optional<double> Percentile(std::vector<double> values, double share) {
  if (values.empty()) {
    return std::nullopt;
  }
  const size_t rank = static_cast<size_t>(std::ceil(share * static_cast<double>(values.size())));
  const size_t index = std::min(values.size() - 1, rank == 0 ? 0 : rank - 1);
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(index), values.end());
  return values[index];
}

}  // namespace alidade
