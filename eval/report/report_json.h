#pragma once

#include <nlohmann/json.hpp>
#include <vector>

namespace alidade {

using Json = nlohmann::ordered_json;

/// A number that JSON can hold, rounded to significant digits; null where it is not finite.
[[nodiscard]] Json RoundedJson(double value, int digits);

/// The numbers of a vector likewise; empty for an empty vector.
[[nodiscard]] Json RoundedJson(const std::vector<double>& values, int digits);

/// Quantiles at 5, 25, 50, 75 and 95 % of the finite values, interpolated; empty without finite values.
[[nodiscard]] std::vector<double> BoxQuantiles(std::vector<double> values);

}  // namespace alidade
