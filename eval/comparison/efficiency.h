#pragma once

#include <limits>
#include <string>
#include <vector>

#include "eval/comparison/aggregate.h"
#include "eval/comparison/comparison.h"

namespace alidade {

/// Bound divided by the achieved value, 1 at the bound; NaN where either is unknown.
struct Ratio {
  double ori = std::numeric_limits<double>::quiet_NaN();
  double pos = std::numeric_limits<double>::quiet_NaN();
};

/// Efficiency of an estimator with respect to the batch estimate (docs/batch.md). All figures are root mean
/// squares over the paired runs: those that it and the batch both finished on equal input. RMSE is unaligned.
struct Efficiency {
  std::string label;
  std::string sequence;
  int pairs = 0;
  Ratio rmse;      ///< achieved: deg, m
  Ratio achieved;  ///< RMSE of the batch divided by RMSE (hindsight)
  Ratio smoothed;  ///< deviation that the batch predicts for itself over RMSE
  Ratio filtered;  ///< deviation given the data up to each frame over RMSE: the bound of online estimators
};

/// One entry an estimator and sequence, in order of first appearance; the first estimator with back end batch
/// is the bound and has its own entry. Empty when the comparison has none.
[[nodiscard]] std::vector<Efficiency> ComputeEfficiency(const Comparison& comparison);

/// efficiency.csv (docs/plans.md lists the columns).
[[nodiscard]] std::string EfficiencyCsv(const std::vector<Efficiency>& entries);

}  // namespace alidade
