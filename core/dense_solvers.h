#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>

namespace alidade {

// Factorisations of small dense matrices, compiled once: each of Eigen's classes costs the compiler seconds
// in every source that uses it.

/// L^-1 of a covariance = L L^T: the whitener W with W covariance W^T = I. 3x3.
[[nodiscard]] Eigen::Matrix3d Whitener(const Eigen::Matrix3d& covariance);

/// Whether a symmetric matrix has a Cholesky factor. 3x3.
[[nodiscard]] bool IsPositiveDefinite(const Eigen::Matrix3d& matrix);

/// a^-1 b, 3x3: of a symmetric `a`, which may be semi-definite (LDL^T), and of a regular one (LU).
[[nodiscard]] Eigen::Vector3d SolveSymmetric(const Eigen::Matrix3d& a, const Eigen::Vector3d& b);
[[nodiscard]] Eigen::Vector3d SolveRegular(const Eigen::Matrix3d& a, const Eigen::Vector3d& b);

/// LDL^T with pivoting of a symmetric n x n matrix, such as that of normal equations.
class SymmetricSolver {
 public:
  explicit SymmetricSolver(const Eigen::Ref<const Eigen::MatrixXd>& matrix);

  /// The factorisation succeeded and no pivot is negative.
  [[nodiscard]] bool positive() const;
  /// The least element of D; NaN when the factorisation failed.
  [[nodiscard]] double min_pivot() const;
  /// a^-1 b, n x k.
  [[nodiscard]] Eigen::MatrixXd Solve(const Eigen::Ref<const Eigen::MatrixXd>& b) const;

 private:
  Eigen::LDLT<Eigen::MatrixXd> factor_;
};

/// R of a = Q R, n x n for m >= n rows (Householder). `right`, if given, becomes Q^T right.
[[nodiscard]] Eigen::MatrixXd UpperTriangle(const Eigen::MatrixXd& a, Eigen::VectorXd* right = nullptr);

}  // namespace alidade
