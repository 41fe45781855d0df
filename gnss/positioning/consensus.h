#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "gnss/positioning/robust_fit.h"

namespace alidade {

/// Robust fit to the majority of the measurements.
struct Consensus {
  Eigen::VectorXd step;      ///< unknowns
  double spread = 0;         ///< deviation of the whitened residuals of those that agree
  Eigen::VectorXd residual;  ///< r + H x of the measurements, whitened

  [[nodiscard]] bool Agrees(Eigen::Index measurement) const;
};

/// Least median of squares (Rousseeuw 1984) of |r + H x| over random samples of as many measurements as there
/// are unknowns, the same for equal input: half of the measurements agree, and a third of those beside the
/// sample. Then least squares over those that agree with the best sample. Rows of a prior take no part.
/// `group`: by measurement, from 0; each group has an unknown of its own, so that every sample has one of
/// each. Nothing with fewer than six measurements more than unknowns, which agree by chance.
[[nodiscard]] std::optional<Consensus> SeekConsensus(const WhitenedRows& rows, const std::vector<int>& group);

}  // namespace alidade
