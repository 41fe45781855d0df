#pragma once

#include <vector>

#include "core/estimator_config.h"

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
/// Huber s up to k^2, then 2 k |r| - k^2; Cauchy k^2 log(1 + s / k^2).
[[nodiscard]] double RobustCost(RobustKernel kernel, double scale_sigma, double squared_norm);

/// IRLS weight in (0, 1] of a whitened residual with squared norm s:
/// Huber min(1, k / |r|), Cauchy 1 / (1 + s / k^2).
[[nodiscard]] double RobustWeight(RobustKernel kernel, double scale_sigma, double squared_norm);

}  // namespace alidade
