#include "eval/simulation/spline_basis.h"

#include <algorithm>
#include <cmath>

namespace alidade {
namespace {

/// Basis of degree `degree` over one segment at x, for the control points i .. i + degree (Cox, de Boor; even
/// knots).
SplineWeights BasisOfDegree(int degree, double x) {
  SplineWeights basis{};
  basis[0] = 1;
  for (int p = 1; p <= degree; ++p) {
    for (int j = p; j >= 0; --j) {
      const auto index = static_cast<std::size_t>(j);
      const double rising = j > 0 ? (x + p - j) / p * basis[index - 1] : 0;
      const double falling = j < p ? (1 + j - x) / p * basis[index] : 0;
      basis[index] = rising + falling;
    }
  }
  return basis;
}

/// From the basis one degree lower, the derivative with respect to x.
SplineWeights Difference(const SplineWeights& lower) {
  SplineWeights result{};
  for (std::size_t j = 0; j < kSplineWeights; ++j) {
    result[j] = (j > 0 ? lower[j - 1] : 0) - lower[j];
  }
  return result;
}

}  // namespace

SplineBasis::SplineBasis(double x)
    : value(BasisOfDegree(kSplineDegree, x)),
      first(Difference(BasisOfDegree(kSplineDegree - 1, x))),
      second(Difference(Difference(BasisOfDegree(kSplineDegree - 2, x)))) {}

SplinePlace LocateOnSpline(double time_s, double spacing_s, std::size_t control_count) {
  const double last_segment = static_cast<double>(control_count - kSplineWeights);
  const double position = std::clamp(time_s / spacing_s, 0.0, last_segment + 1);
  const double segment = std::min(std::floor(position), last_segment);
  return {static_cast<std::size_t>(segment), position - segment};
}

}  // namespace alidade
