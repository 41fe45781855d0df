#include "gnss/positioning/robust_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

namespace alidade {

std::optional<RobustFit> RobustStep(const WhitenedRows& rows, RobustKernel kernel, double kernel_scale,
                                    bool weighted) {
  const Eigen::Index unknowns = rows.jacobian.cols();
  if (rows.jacobian.rows() < unknowns || !rows.jacobian.allFinite() || !rows.residual.allFinite()) {
    return std::nullopt;
  }
  Eigen::MatrixXd jacobian = rows.jacobian;
  Eigen::VectorXd residual = rows.residual;
  for (Eigen::Index i = 0; weighted && i < rows.measurements; ++i) {
    const double root = std::sqrt(RobustWeight(kernel, kernel_scale, residual[i] * residual[i]));
    jacobian.row(i) *= root;
    residual[i] *= root;
  }
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(jacobian);
  // Weak priors span ten orders of magnitude: only what is not determined at all is refused.
  if (qr.rank() < unknowns) {
    return std::nullopt;
  }
  RobustFit fit;
  fit.step = qr.solve(-residual);
  const Eigen::MatrixXd inverse = qr.matrixR()
                                      .topLeftCorner(unknowns, unknowns)
                                      .triangularView<Eigen::Upper>()
                                      .solve(Eigen::MatrixXd::Identity(unknowns, unknowns));
  const Eigen::MatrixXd permuted = qr.colsPermutation() * inverse;
  fit.covariance = permuted * permuted.transpose();
  return fit.step.allFinite() ? std::optional(fit) : std::nullopt;
}

double RobustScale(const std::vector<double>& whitened, int unknowns) {
  const auto count = static_cast<int>(whitened.size());
  if (count <= unknowns) {
    return 1;
  }
  std::vector<double> magnitudes;
  magnitudes.reserve(whitened.size());
  for (const double value : whitened) {
    magnitudes.push_back(std::abs(value));
  }
  const auto middle = magnitudes.begin() + count / 2;
  std::nth_element(magnitudes.begin(), middle, magnitudes.end());
  const double spread = std::sqrt(static_cast<double>(count) / (count - unknowns));
  return std::max(1.0, 1.4826 * *middle * spread);
}

}  // namespace alidade
