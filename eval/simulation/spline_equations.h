#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCholesky>
#include <array>
#include <cstddef>
#include <vector>

#include "eval/simulation/spline_basis.h"

namespace alidade {

/// The normal matrix of a least-squares fit of spline coefficients, and the product of its right-hand side.
/// Position and rotation have the same form: both residuals are sum_j b_j(x) (change of control point i + j)
/// to first order.
class SplineEquations {
 public:
  /// With the wishes for even spacing and for little change at the ends; `end_order` (2 or 3) is that of the
  /// difference at the ends.
  SplineEquations(std::size_t control_count, int end_order);

  void AddRow(const SplinePlace& place, const SplineWeights& weights);
  /// Of all rows; false when they do not determine the control points.
  bool Factorize();

  void ClearRight() { right_.setZero(); }
  void AddRight(const SplinePlace& place, const SplineWeights& weights, const Eigen::Vector3d& residual);
  /// The wishes pull on control points that exist already; `steps` are the steps from one control point to
  /// the next (for rotations their logarithms in W).
  void AddWishes(const std::vector<Eigen::Vector3d>& steps);
  /// One row a control point.
  [[nodiscard]] Eigen::MatrixXd Solve() const { return solver_.solve(right_); }

 private:
  /// A difference of neighbouring control points that should be small.
  struct Wish {
    std::size_t first = 0;
    std::array<double, 4> difference = {};
    std::size_t count = 0;  ///< of coefficients in use
    double weight = 0;
  };

  std::vector<Wish> wishes_;
  std::vector<Eigen::Triplet<double>> entries_;
  Eigen::MatrixXd right_;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver_;
};

}  // namespace alidade
