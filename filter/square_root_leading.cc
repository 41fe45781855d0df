#include <Eigen/Cholesky>
#include <Eigen/QR>

#include "core/check.h"
#include "filter/square_root_covariance.h"
#include "filter/triangularize.h"

// A leading block with dynamics of its own, and the factor as a whole, of SquareRootCovariance.

namespace alidade {

using Eigen::Index;
using Eigen::MatrixXd;

void SquareRootCovariance::PropagateLeading(int first, const Matrix6d& phi, const Matrix6d& q) {
  constexpr int kSize = 6;
  CHECK(first >= 0 && first + kSize <= leading_);
  // Of a diagonal block the factor's own triangle is reused; a part without noise needs no root.
  const Eigen::LDLT<Matrix6d> factor(q);
  const Matrix6d root = factor.transpositionsP().transpose() *
                        Matrix6d(Matrix6d(factor.matrixL()) *
                                 factor.vectorD().cwiseMax(0).cwiseSqrt().asDiagonal().toDenseMatrix());
  auto stacked = corner_.topLeftCorner(first + kSize, 2 * kSize);
  stacked.topLeftCorner(first, kSize).setZero();
  stacked.topRightCorner(first, kSize) = Part(0, first, first, kSize);
  stacked.bottomLeftCorner(kSize, kSize) = root;
  const Matrix6d before = Part(first, first, kSize, kSize).triangularView<Eigen::Upper>();
  const Matrix6d after = phi * before;
  stacked.bottomRightCorner(kSize, kSize) = after;
  TriangularizeBottom(stacked, kSize, &reflection_);
  Part(0, first, first + kSize, kSize) = stacked.rightCols(kSize);
  FoldColumns(Part(0, 0, first, first), stacked.topLeftCorner(first, kSize), &reflection_);
  for (Index column = first + kSize; column < dimension_; ++column) {
    Eigen::Map<Vector6d> cross(Data(first, static_cast<int>(column)));
    const Vector6d old = cross;
    cross.noalias() = phi * old;
  }
}

void SquareRootCovariance::Assign(int leading, const Eigen::Ref<const MatrixXd>& root) {
  CHECK_LE(leading, max_leading_);
  const Index n = root.rows();
  CHECK_LE(n - leading, capacity() - max_leading_);
  CHECK_GE(root.cols(), n);
  // With the rows reversed, an LQ factorisation gives a lower triangle, which reversed again is an upper one.
  const MatrixXd reversed = root.colwise().reverse().transpose();
  const Eigen::HouseholderQR<MatrixXd> qr(reversed);
  const MatrixXd lower = qr.matrixQR().topRows(n).triangularView<Eigen::Upper>().toDenseMatrix().transpose();
  leading_ = leading;
  origin_ = max_leading_ - leading;
  dimension_ = static_cast<int>(n);
  Part(0, 0, n, n) = lower.reverse();
}

}  // namespace alidade
