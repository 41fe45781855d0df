#pragma once

#include <limits>
#include <numbers>

namespace alidade {

inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
inline constexpr double kDegreesPerRadian = 180.0 / std::numbers::pi;
inline constexpr double kRadiansPerDegree = std::numbers::pi / 180.0;

}  // namespace alidade
