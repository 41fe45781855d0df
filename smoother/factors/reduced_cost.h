#pragma once

#include <Eigen/Core>

#include "smoother/window/window_point.h"

namespace alidade {

/// Normal equations of |r + J x|^2.
struct NormalEquations {
  Eigen::MatrixXd hessian;   ///< J^T J, lower triangle
  Eigen::VectorXd gradient;  ///< J^T r
};

/// A cost over the states of a window whose landmarks are solved for inside: variable projection,
///
///     F(X) = min_f C(X, f).
///
/// Exactness. dF/dX needs no derivative of f (it is stationary: envelope theorem), so the gradient is exact.
/// The information is that of C once its landmarks are eliminated: Kaufman's form of variable projection (BIT
/// 15, 1975), the Gauss-Newton matrix of the full bundle adjustment. (Golub and Pereyra's extra term is of
/// the size of the residual times the curvature, as what Gauss-Newton drops anyway.) Minimum and covariance
/// are therefore those of explicit landmarks; what differs is the path to it.
class ReducedCost {
 public:
  /// F where the solver shall refuse a step.
  static constexpr double kRefused = 1e8;

  ReducedCost() = default;
  ReducedCost(const ReducedCost&) = delete;
  ReducedCost& operator=(const ReducedCost&) = delete;
  ReducedCost(ReducedCost&&) = delete;
  ReducedCost& operator=(ReducedCost&&) = delete;
  virtual ~ReducedCost() = default;

  /// Solves for the landmarks at a point and returns F, twice what Ceres calls the cost. Where a landmark
  /// lies behind a view it is so large that the solver refuses the step.
  virtual double Solve(const WindowPoint& point) = 0;
  /// Normal equations at the point of the last Solve, canonical chart. False: undefined there.
  [[nodiscard]] virtual bool Linearize(NormalEquations* equations) = 0;
};

}  // namespace alidade
