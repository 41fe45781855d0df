#pragma once

#include <Eigen/Core>
#include <vector>

#include "smoother/solve/window_term.h"

namespace alidade {

/// Sparse QR of the whitened rows of a window's terms, over the canonical chart: columns are eliminated in
/// their order, a group at a time. Only the rows that reach a group take part in its step, over the columns
/// that they touch, and stay triangular afterwards (the multifrontal method; Duff and Reid 1983, Matstoms
/// 1994). Normal equations are never formed: they would square the condition number.
class RowElimination {
 public:
  using Index = Eigen::Index;

  /// `with_residual`: of the rows too, for residual().
  explicit RowElimination(ColumnMap columns, bool with_residual = false);

  [[nodiscard]] const ColumnMap& columns() const { return columns_; }
  /// Adds the rows of a term; normal equations are replaced by a square root first (LinearTerm::MakeRows).
  void Add(LinearTerm* term);
  /// Eliminates the columns from those already eliminated up to `end`. False: the rows do not determine them,
  /// or a number is not finite.
  bool EliminateUpTo(Index end);
  /// R of the group eliminated last, upper triangular: once no column is left, R^T R is the information about
  /// that group.
  [[nodiscard]] const Eigen::MatrixXd& root() const { return root_; }
  /// r of the same rows: once no column is left, the group's minimum is -R^-1 r. Only with the residual.
  [[nodiscard]] const Eigen::VectorXd& residual() const { return residual_; }
  /// R of all columns eliminated so far, upper triangular: once no column is left, R^T R is the information
  /// about all of them.
  [[nodiscard]] const Eigen::MatrixXd& factor() const { return factor_; }

 private:
  using RowMajorMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  /// Rows that reach columns before `end`.
  [[nodiscard]] std::vector<Index> ActiveRows(Index end) const;
  /// Columns that are not eliminated yet and which `active` rows touch; all of those before `end`.
  [[nodiscard]] std::vector<Index> TouchedColumns(const std::vector<Index>& active, Index end) const;

  ColumnMap columns_;
  bool with_residual_;
  RowMajorMatrix rows_;  ///< with the residual, that is the last column
  Index count_ = 0;
  std::vector<Index> lead_;  ///< of each row: no column before this one is touched
  Index eliminated_ = 0;
  Eigen::MatrixXd root_;
  Eigen::VectorXd residual_;
  Eigen::MatrixXd factor_;
};

}  // namespace alidade
