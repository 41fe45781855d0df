#include <Eigen/Cholesky>

#include "core/check.h"
#include "filter/square_root_covariance.h"
#include "filter/triangularize.h"

// The blocks of SquareRootCovariance that have dynamics of their own.

namespace alidade {

using Eigen::Index;

template <int kSize>
void SquareRootCovariance::PropagateBlock(int first, const Eigen::Matrix<double, kSize, kSize>& phi,
                                          const Eigen::Matrix<double, kSize, kSize>& noise_root) {
  auto stacked = corner_.topLeftCorner(first + kSize, 2 * kSize);
  stacked.topLeftCorner(first, kSize).setZero();
  stacked.topRightCorner(first, kSize) = Part(0, first, first, kSize);
  stacked.bottomLeftCorner(kSize, kSize) = noise_root;
  const Eigen::Matrix<double, kSize, kSize> before =
      Part(first, first, kSize, kSize).template triangularView<Eigen::Upper>();
  const Eigen::Matrix<double, kSize, kSize> after = phi * before;
  stacked.bottomRightCorner(kSize, kSize) = after;
  TriangularizeBottom(stacked, kSize, &reflection_);
  Part(0, first, first + kSize, kSize) = stacked.rightCols(kSize);
  FoldColumns(Part(0, 0, first, first), stacked.topLeftCorner(first, kSize), &reflection_);
  for (Index column = first + kSize; column < dimension_; ++column) {
    Eigen::Map<Eigen::Matrix<double, kSize, 1>> cross(Data(first, static_cast<int>(column)));
    const Eigen::Matrix<double, kSize, 1> old = cross;
    cross.noalias() = phi * old;
  }
}

void SquareRootCovariance::Propagate(const Matrix15d& phi, const Matrix15d& noise_root) {
  PropagateBlock<kCore>(leading_, phi, noise_root);
}

void SquareRootCovariance::PropagateLeading(int first, const Matrix6d& phi, const Matrix6d& q) {
  CHECK(first >= 0 && first + 6 <= leading_);
  // Of a diagonal block the factor's own triangle is reused; a part without noise needs no root.
  const Eigen::LDLT<Matrix6d> factor(q);
  const Matrix6d root = factor.transpositionsP().transpose() *
                        Matrix6d(Matrix6d(factor.matrixL()) *
                                 factor.vectorD().cwiseMax(0).cwiseSqrt().asDiagonal().toDenseMatrix());
  PropagateBlock<6>(first, phi, root);
}

}  // namespace alidade
