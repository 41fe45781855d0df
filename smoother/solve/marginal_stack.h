#pragma once

#include <Eigen/Core>

#include "smoother/factors/prior_factor.h"
#include "smoother/solve/window_term.h"

namespace alidade {

/// Whitened rows over the coordinates of priors (errors of a convention around the present states, or around
/// first estimates where frames have such). QR eliminates the leading columns.
class MarginalStack {
 public:
  using Index = Eigen::Index;

  /// `leaving`: how many of the columns come first and are eliminated.
  MarginalStack(const Window& window, ErrorConvention convention, ColumnMap columns, Index leaving);

  [[nodiscard]] const ColumnMap& columns() const { return columns_; }
  /// Zero rows at the end; the first of them.
  Index NewRows(Index count);
  /// Of some of the rows.
  [[nodiscard]] auto Columns(const ColumnMap::Range& range, Index first_row, Index rows) {
    return stack_.block(first_row, range.first, rows, range.size);
  }
  [[nodiscard]] auto Residual(Index first_row, Index rows) {
    return stack_.col(columns_.size()).segment(first_row, rows);
  }
  /// d (phi, dp) of a frame's body / d its columns.
  [[nodiscard]] Matrix6d PoseChart(int frame) const;
  /// The same of its whole state.
  [[nodiscard]] Matrix15d StateChart(int frame) const;
  /// The rows of a term.
  void Add(LinearTerm* term);
  /// The rows that are left, over the columns that stay.
  void Eliminate(Eigen::MatrixXd* jacobian, Eigen::VectorXd* residual);

 private:
  const Window& window_;
  ErrorConvention convention_;
  ColumnMap columns_;
  Index leaving_;
  Eigen::MatrixXd stack_;  ///< the residual is its last column
  Index rows_ = 0;
};

}  // namespace alidade
