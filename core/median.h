#pragma once

#include <vector>

namespace alidade {

/// The upper one of two middle values. `values` must not be empty.
[[nodiscard]] double Median(std::vector<double> values);

}  // namespace alidade
