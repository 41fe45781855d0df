#pragma once

#include <array>
#include <utility>
#include <vector>

#include "eval/identify/allan_variance.h"

namespace alidade {

/// A noise coefficient with its 95 % interval.
struct NoiseCoefficient {
  double value = 0;  ///< 0 when it is not visible
  double low = 0;
  double high = 0;  ///< of one that is not visible: the upper bound
  bool visible = false;
};

/// The noise of a rate from its Allan variance.
struct NoiseFit {
  std::array<NoiseCoefficient, NoisePowers::kCount> coefficients;  ///< Q, N, B, K by NoisePowers::Index
  NoisePowers powers;                                              ///< of the visible ones
  std::vector<double> dof;  ///< equivalent degrees of freedom of each point, 2 variance^2 / its variance
  double chi_square = 0;    ///< of the points about the fit
  int chi_square_dof = 0;

  [[nodiscard]] const NoiseCoefficient& operator[](NoisePowers::Index index) const {
    return coefficients[index];
  }
};

/// Fits the four powers, all at least zero, to the points. Each set of noises is fitted by generalised least
/// squares with the covariance of AllanCovariance at the fit itself (iterated), plus an error of the model of
/// kModelError of each variance. Of the sets that has the least
///
///   r^T C^-1 r + log det C + 6.63 (number of noises),
///
/// so that a noise is visible when it is needed at 99 %. Intervals are those of a chi-square variable with
/// the mean and variance of the fitted power (Satterthwaite), widened by chi-square over its degrees of
/// freedom when that exceeds one. The bound of an invisible noise is where the criterion without its penalty
/// has risen by 3.84 from its value without the noise or its least value.
///
/// `covariance`: of these points. Precondition: at least four points.
[[nodiscard]] NoiseFit FitNoise(const std::vector<AllanPoint>& points, const AllanCovariance& covariance);

/// Noises that the four coefficients cannot render (filters inside the sensor, tones) are taken to change a
/// point's variance by this share, independently.
inline constexpr double kModelError = 0.05;

/// 95 % interval of a variance estimated with `dof` degrees of freedom, as factors on the estimate.
[[nodiscard]] std::pair<double, double> VarianceInterval(double dof);

}  // namespace alidade
