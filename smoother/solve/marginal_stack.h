#pragma once

#include <Eigen/Core>
#include <vector>

#include "smoother/factors/prior_factor.h"
#include "smoother/solve/window_term.h"

namespace alidade {

/// d (phi, dp) of a frame's body / d its columns in the next prior: errors in its chart around the
/// present state, or around the first estimate where the frame has one.
[[nodiscard]] Matrix6d PosePriorChart(const StateChart& chart, const WindowFrame& frame);
/// The same of its whole state.
[[nodiscard]] Matrix15d StatePriorChart(const StateChart& chart, const WindowFrame& frame);

/// The slope of a spread (LinearPrior::SpreadAt at the present states) over the same columns of each anchor.
[[nodiscard]] Eigen::Matrix<double, 6, Eigen::Dynamic> SpreadPriorSlope(
    const LinearPrior& prior, const LinearPrior::SpreadChange& change, const StateChart& chart);

/// Whitened rows over the coordinates of priors (errors in their chart around the present states, or around
/// first estimates where frames have such). QR eliminates the leading columns.
class MarginalStack {
 public:
  using Index = Eigen::Index;

  /// `leaving`: how many of the columns come first and are eliminated.
  MarginalStack(const Window& window, const StateChart& chart, ColumnMap columns, Index leaving);

  /// The rows of a term; those of a prior as they are: CarriedPrior has them in the chart.
  void Add(LinearTerm* term);
  /// Adds the least information about coordinates that leave, of which the terms so far may leave some
  /// undetermined: an undetermined one takes a row of the others along.
  void MakeRegular(const ColumnMap::Range& of);
  /// The rows that are left, over the columns that stay.
  void Eliminate(Eigen::MatrixXd* jacobian, Eigen::VectorXd* residual);

 private:
  /// Zero rows at the end; the first of them.
  Index NewRows(Index count);
  [[nodiscard]] bool IsEmpty(Index column) const;
  /// The rows in the order of their first entries, each at the place of that column or later. In the place of
  /// a column without entries is a zero row: the triangle's row there would take up one that has information.
  [[nodiscard]] Eigen::MatrixXd Staircase() const;

  const Window& window_;
  StateChart chart_;
  ColumnMap columns_;
  Index leaving_;
  Eigen::MatrixXd stack_;  ///< the residual is its last column
  Index rows_ = 0;
};

}  // namespace alidade
