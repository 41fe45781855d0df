#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/robust.h"

namespace alidade {

/// A linear least-squares step with robust weights.
struct RobustFit {
  Eigen::VectorXd step;        ///< unknowns that minimise the weighted |H x + r|^2
  Eigen::MatrixXd covariance;  ///< (H^T W H)^-1, not scaled
};

/// Rows of the form r + H x = noise, whitened; rows of a prior come last and are never down-weighted.
struct WhitenedRows {
  Eigen::MatrixXd jacobian;
  Eigen::VectorXd residual;
  Eigen::Index measurements = 0;  ///< leading rows that are measurements
};

/// One step with the weights that RobustWeight gives at the present residuals (x = 0). Nothing when the
/// unknowns are not determined.
[[nodiscard]] std::optional<RobustFit> RobustStep(const WhitenedRows& rows, RobustKernel kernel,
                                                  double kernel_scale, bool weighted);

/// 1.4826 times the median of |residual|, corrected for `unknowns` that were fitted; 1 without redundancy and
/// at least 1.
[[nodiscard]] double RobustScale(const std::vector<double>& whitened, int unknowns);

}  // namespace alidade
