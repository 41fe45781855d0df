#pragma once

#include <vector>

namespace alidade::test {

/// first, first + step, first + 2 step and so on, all below `end`.
inline std::vector<double> Steps(double first, double end, double step) {
  std::vector<double> values;
  for (int k = 0; first + k * step < end; ++k) {
    values.push_back(first + k * step);
  }
  return values;
}

}  // namespace alidade::test
