#pragma once

#include <Eigen/Core>

#include "core/lie.h"
#include "core/status.h"

namespace alidade {

/// Covariance kept as an upper-triangular factor, P = S S^T: symmetric and positive semi-definite by
/// construction, whatever is done to it. The error is ordered [core (15), blocks newest first]: upper
/// triangularity then makes propagation and cloning touch a corner only. Storage is allocated once for
/// `capacity`.
class SquareRootCovariance {
 public:
  static constexpr int kCore = 15;

  explicit SquareRootCovariance(int capacity);

  /// Restarts with the core block alone. kInput: not symmetric positive semi-definite to rounding.
  Status Reset(const Matrix15d& covariance);

  /// core <- phi core + w, w ~ N(0, q); cross terms follow.
  void Propagate(const Matrix15d& phi, const Matrix15d& q);

  /// Inserts a copy of the error rows [first, first + size) of the core block directly after the core block.
  void CloneCore(int first, int size);

  /// Marginalises the rows [first, first + size), which lie outside the core block.
  void Remove(int first, int size);

  /// Kalman update with unit-noise rows H over the whole error (rows x dimension()) and innovation y =
  /// measured - predicted. Prepare computes A = H S, in place; rows may then be gated or re-weighted in A and
  /// y before Apply.
  void Prepare(Eigen::Ref<Eigen::MatrixXd> rows_in_place) const;
  /// M = I + A^T A = U^T U; S <- S U^-1; correction = S U^-T A^T y. nis (nullptr skips): y^T (A A^T + I)^-1
  /// y, the normalised innovation squared. False, with nothing changed, when a row is not finite: M is at
  /// least the identity, so nothing else can stop its factorisation.
  bool Apply(const Eigen::Ref<const Eigen::MatrixXd>& prepared_rows,
             const Eigen::Ref<const Eigen::VectorXd>& y, Eigen::VectorXd* correction, double* nis);

  [[nodiscard]] int dimension() const { return dimension_; }
  [[nodiscard]] int capacity() const { return static_cast<int>(factor_.rows()); }
  /// The factor, dimension() x dimension(), upper triangular.
  [[nodiscard]] auto factor() const { return factor_.topLeftCorner(dimension_, dimension_); }
  [[nodiscard]] Matrix15d CoreCovariance() const;
  /// Covariance of the rows [row, row + 6) with [column, column + 6).
  [[nodiscard]] Matrix6d PoseBlock(int row, int column) const;
  /// The whole covariance; for tests and reports, not for a hot path.
  [[nodiscard]] Eigen::MatrixXd Covariance() const;
  [[nodiscard]] bool AllFinite() const { return factor().allFinite(); }

 private:
  int dimension_ = 0;
  Eigen::MatrixXd factor_;
  Eigen::MatrixXd information_;  // scratch of Apply
  Eigen::VectorXd projected_;
  Eigen::VectorXd reflection_;
};

/// Lower factor L of a symmetric positive semi-definite matrix, M = L L^T; pivots below rounding give zero
/// columns. False when a pivot is clearly negative or not finite.
bool SemiDefiniteCholesky(const Matrix15d& matrix, Matrix15d* lower);

}  // namespace alidade
