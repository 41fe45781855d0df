#pragma once

#include <array>
#include <cstddef>

namespace alidade {

/// Of the B-splines.
inline constexpr int kSplineDegree = 5;
/// Control points that bear on one instant.
inline constexpr int kSplineWeights = kSplineDegree + 1;

using SplineWeights = std::array<double, kSplineWeights>;

/// Weights of the control points i .. i + 5 over one segment, x in [0, 1), and their derivatives.
struct SplineBasis {
  SplineWeights value = {};
  SplineWeights first = {};   ///< d / dx
  SplineWeights second = {};  ///< d^2 / dx^2

  explicit SplineBasis(double x);
};

/// Where on the spline an instant lies.
struct SplinePlace {
  std::size_t segment = 0;
  double x = 0;
};

/// `time_s` since the first sample; an instant outside lies at the nearest end.
[[nodiscard]] SplinePlace LocateOnSpline(double time_s, double spacing_s, std::size_t control_count);

}  // namespace alidade
