#pragma once

#include <vector>

#include "core/robust_kernel.h"

namespace alidade {

/// Upper quantile of the chi-square distribution: P(x <= value) = probability. probability 1 gives infinity.
[[nodiscard]] double ChiSquareQuantile(int dof, double probability);

/// Chi-square gates for 1..max_dof degrees of freedom, computed once.
class ChiSquareGate {
 public:
  explicit ChiSquareGate(double probability, int max_dof = 256);
  /// True when a normalised innovation squared of `dof` degrees of freedom is inside the gate.
  [[nodiscard]] bool Accepts(double nis, int dof) const;
  [[nodiscard]] double Threshold(int dof) const;

 private:
  double probability_;
  std::vector<double> thresholds_;
};

/// Cost rho(s) of a whitened residual with squared norm s, whose slope is RobustWeight:
/// Huber s up to k^2, then 2 k |r| - k^2; Cauchy k^2 log(1 + s / k^2); log tail s up to k^2, then k^2 (1 +
/// log(s / k^2)).
[[nodiscard]] double RobustCost(RobustKernel kernel, double scale_sigma, double squared_norm);

/// IRLS weight in (0, 1] of a whitened residual with squared norm s:
/// Huber min(1, k / |r|), Cauchy 1 / (1 + s / k^2), log tail min(1, k^2 / s).
[[nodiscard]] double RobustWeight(RobustKernel kernel, double scale_sigma, double squared_norm);

/// The robust kernel of one observation, rho(s) of its whitened squared residual s, with rho'(0) = 1.
struct ObservationKernel {
  RobustKernel kernel = RobustKernel::kNone;
  double scale_sigma = 1;

  [[nodiscard]] double Rho(double s) const { return RobustCost(kernel, scale_sigma, s); }
  /// rho'(s).
  [[nodiscard]] double Weight(double s) const { return RobustWeight(kernel, scale_sigma, s); }
  /// rho''(s), at most 0.
  [[nodiscard]] double SecondDerivative(double s) const;
  /// rho' + 2 s rho'': second derivative of rho(|r|^2) / 2 along r. Zero or negative in the tails.
  [[nodiscard]] double RadialCurvature(double s) const;
};

/// A scalar whitened residual whose square is the kernel's cost rho(r^2), with rho' = RobustWeight:
/// Huber r^2 up to k, then 2 k |r| - k^2; Cauchy k^2 log(1 + r^2 / k^2); log tail r^2 up to k, then k^2 (1 +
/// 2 log(|r| / k)).
struct RobustResidual {
  double value = 0;  ///< sign(r) sqrt(rho(r^2))
  double slope = 1;  ///< d value / d r
};
[[nodiscard]] RobustResidual Robustify(RobustKernel kernel, double scale_sigma, double residual);

/// Whether so many of `total` measurements failed their gates that the state is suspect and not the
/// measurements: more than `max_refused_share` of them, and at least `least_refused`. A caller then uses them
/// all, those beyond the gate scaled down to it.
///
/// `least_refused` keeps a few wrong measurements among few from passing for a wrong state. With wrong
/// measurements in independent proportion q, more than half of n are wrong with the binomial probability
/// P(X > n/2); the least number is the smallest for which that is 5 % or less for every n it admits.
[[nodiscard]] bool StateIsSuspect(int refused, int total, double max_refused_share, int least_refused);

/// For tracks: q = 0.3, as where a large moving object or a failed outlier rejection spoils them.
inline constexpr int kLeastRefusedTracks = 8;
/// For pseudoranges and range rates: q = 0.2, as with reflections between buildings.
inline constexpr int kLeastRefusedGnssRows = 4;

}  // namespace alidade
