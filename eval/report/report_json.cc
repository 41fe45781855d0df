#include "eval/report/report_json.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

namespace alidade {

Json RoundedJson(double value, int digits) {
  if (!std::isfinite(value)) {
    return nullptr;
  }
  char buffer[64];
  std::snprintf(buffer, sizeof(buffer), "%.*g", digits, value);
  const double rounded = std::strtod(buffer, nullptr);
  // An integer prints without ".0".
  return std::abs(rounded) < 1e15 && rounded == std::floor(rounded) ? Json(static_cast<long long>(rounded))
                                                                    : Json(rounded);
}

Json RoundedJson(const std::vector<double>& values, int digits) {
  Json list = Json::array();
  for (const double value : values) {
    list.push_back(RoundedJson(value, digits));
  }
  return list;
}

std::vector<double> BoxQuantiles(std::vector<double> values) {
  values.erase(std::remove_if(values.begin(), values.end(), [](double v) { return !std::isfinite(v); }),
               values.end());
  std::sort(values.begin(), values.end());
  std::vector<double> quantiles;
  for (const double share : {0.05, 0.25, 0.5, 0.75, 0.95}) {
    if (!values.empty()) {
      const double place = share * static_cast<double>(values.size() - 1);
      const size_t below = static_cast<size_t>(place);
      const size_t above = std::min(below + 1, values.size() - 1);
      const double part = place - static_cast<double>(below);
      quantiles.push_back(values[below] + part * (values[above] - values[below]));
    }
  }
  return quantiles;
}

}  // namespace alidade
