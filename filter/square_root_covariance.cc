#include "filter/square_root_covariance.h"

#include <cblas.h>

#include <algorithm>

#include "core/blas.h"
#include "core/check.h"
#include "core/dense_solvers.h"
#include "core/semi_definite.h"
#include "filter/triangularize.h"

namespace alidade {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

// More than the rows that an update usually has; no power of two, with which all columns
// would share cache sets.
constexpr Index kUsualRows = 520;

}  // namespace

SquareRootCovariance::SquareRootCovariance(int capacity, int max_leading, UpdatePrecision precision)
    : max_leading_(max_leading),
      origin_(max_leading),
      factor_(MatrixXd::Zero(capacity, capacity)),
      information_(MatrixXd::Zero(capacity, capacity)),
      corner_(MatrixXd::Zero(max_leading + 2 * kCore, 2 * kCore)),
      projected_(VectorXd::Zero(capacity)),
      whitened_(VectorXd::Zero(capacity)),
      step_(VectorXd::Zero(capacity)),
      reflection_(VectorXd::Zero(capacity)),
      precision_(precision) {
  if (precision == UpdatePrecision::kSingle) {
    single_factor_.setZero(capacity, capacity);
    single_information_.setZero(capacity, capacity);
    single_rows_.resize(kUsualRows, capacity);
  }
  CHECK_GE(capacity, kCore + max_leading);
  UseOneThreadPerBlasCall();
}

Status SquareRootCovariance::Reset(const Matrix15d& covariance) {
  if (!covariance.allFinite() || (covariance - covariance.transpose()).norm() > 1e-9 * covariance.norm()) {
    return Status::Input("initial covariance: expected a finite symmetric 15 x 15 matrix");
  }
  Matrix15d lower;
  if (!SemiDefiniteCholesky(covariance, &lower)) {
    return Status::Input("initial covariance: expected positive semi-definite");
  }
  dimension_ = kCore;
  leading_ = 0;
  origin_ = max_leading_;
  auto core = corner_.topLeftCorner(kCore, kCore);
  core = lower;
  TriangularizeBottom(core, kCore, &reflection_);
  Part(0, 0, kCore, kCore) = core;
  return Status::Ok();
}

void SquareRootCovariance::Assign(int leading, const Eigen::Ref<const MatrixXd>& root) {
  CHECK_LE(leading, max_leading_);
  const Index n = root.rows();
  CHECK_LE(n - leading, capacity() - max_leading_);
  CHECK_GE(root.cols(), n);
  // With the rows reversed, an LQ factorisation gives a lower triangle, which reversed again is an upper one.
  const MatrixXd reversed = root.colwise().reverse().transpose();
  const MatrixXd lower = UpperTriangle(reversed).transpose();
  leading_ = leading;
  origin_ = max_leading_ - leading;
  dimension_ = static_cast<int>(n);
  Part(0, 0, n, n) = lower.reverse();
}

bool SquareRootCovariance::AllFinite() const {
  return factor().allFinite();
}

void SquareRootCovariance::CloneCore(int first, int size) {
  CHECK(first >= 0 && size <= kCore && first + size <= kCore);
  CHECK_LE(origin_ + dimension_ + size, capacity());
  const Index head = leading_ + kCore;
  // Make room after the core block, last column first so that nothing is overwritten unread.
  for (Index column = dimension_ - 1; column >= head; --column) {
    const Index target = column + size;
    const Index tail = column - head + 1;
    auto from = Part(0, column, dimension_ + size, 1);
    auto to = Part(0, target, dimension_ + size, 1);
    to.middleRows(head + size, tail) = from.middleRows(head, tail);
    to.topRows(head) = from.topRows(head);
    to.middleRows(head, size) = from.middleRows(leading_ + first, size);
    to.bottomRows(dimension_ + size - target - 1).setZero();
  }
  // The core's rows and their copies have `size` more rows than columns: restore the triangle.
  auto corner = corner_.topLeftCorner(head + size, kCore + size);
  corner.leftCols(size).setZero();
  corner.topRightCorner(head, kCore) = Part(0, leading_, head, kCore);
  corner.block(leading_, size, kCore, kCore).triangularView<Eigen::StrictlyLower>().setZero();
  corner.bottomRightCorner(size, kCore) = corner.block(leading_ + first, size, size, kCore);
  TriangularizeBottom(corner, kCore + size, &reflection_);
  Part(0, leading_, head + size, kCore + size) = corner;
  dimension_ += size;
}

void SquareRootCovariance::AddTrailing(const Eigen::Ref<const VectorXd>& deviations) {
  const Index size = deviations.size();
  CHECK_LE(origin_ + dimension_ + size, capacity());
  Part(0, dimension_, dimension_ + size, size).setZero();
  Part(dimension_, 0, size, dimension_).setZero();
  Part(dimension_, dimension_, size, size).diagonal() = deviations;
  dimension_ += static_cast<int>(size);
}

void SquareRootCovariance::AddToRows(int target,
                                     const Eigen::Ref<const Eigen::Matrix<double, 6, Eigen::Dynamic>>& gain,
                                     int source) {
  CHECK(target >= 0 && target + 6 <= source && source + gain.cols() <= dimension_);
  const Index columns = dimension_ - source;
  Part(target, source, 6, columns).noalias() += gain * Part(source, source, gain.cols(), columns);
}

void SquareRootCovariance::AddLeading(const Eigen::Matrix3d& root, const Eigen::Ref<const MatrixXd>& gain) {
  CHECK_EQ(gain.cols(), dimension_ - leading_);
  CHECK_LE(leading_ + 3, max_leading_);
  const int tail = dimension_ - leading_;
  origin_ -= 3;
  leading_ += 3;
  dimension_ += 3;
  Part(0, 0, dimension_, 3).setZero();
  Part(0, 3, 3, leading_ - 3).setZero();
  Part(0, 0, 3, 3) = root.triangularView<Eigen::Upper>();
  Part(0, leading_, 3, tail) = gain;
  cblas_dtrmm(CblasColMajor, CblasRight, CblasUpper, CblasNoTrans, CblasNonUnit, 3, tail, 1.0,
              Data(leading_, leading_), capacity(), Data(0, leading_), capacity());
}

void SquareRootCovariance::AddToLeading(int target, const Eigen::Matrix3d& m, int source) {
  CHECK(target >= 0 && target + 3 <= leading_ && source >= leading_ && source + 3 <= dimension_);
  const Index columns = dimension_ - source;
  Part(target, source, 3, columns).noalias() += m * Part(source, source, 3, columns);
}

void SquareRootCovariance::Shear(const Eigen::Ref<const VectorXd>& column,
                                 const Eigen::Ref<const VectorXd>& row) {
  CHECK(column.size() == dimension_ && row.size() == dimension_);
  // S + column (S^T row)^T. Rotations of neighbouring columns gather S^T row in the last one, where S may be
  // full. They leave one diagonal below that of S, which rotations from the end on remove.
  const int last = dimension_ - 1;
  auto w = whitened_.head(dimension_);
  w.noalias() = factor().transpose() * row;
  Eigen::JacobiRotation<double> rotation;
  for (int j = 0; j < last; ++j) {
    if (w(j) != 0) {
      rotation.makeGivens(w(j + 1), w(j), &w(j + 1));
      Part(0, j, j + 2, 2).applyOnTheRight(1, 0, rotation);
    }
  }
  Part(0, last, dimension_, 1) += w(last) * column;
  for (int j = last - 1; j >= 0; --j) {
    double* below = Data(j + 1, j);
    if (*below != 0) {
      rotation.makeGivens(*Data(j + 1, j + 1), *below);
      Part(0, j, j + 2, 2).applyOnTheRight(1, 0, rotation);
      *below = 0;
    }
  }
}

void SquareRootCovariance::Remove(int first, int size) {
  CHECK(first >= 0 && first + size <= dimension_);
  CHECK(first + size <= leading_ || first >= leading_ + kCore) << "the core block stays";
  // Without its rows, the block's columns are surplus for the rows above: fold them into the triangle there.
  FoldColumns(Part(0, 0, first, first), Part(0, first, first, size), &reflection_);
  if (first < leading_) {
    RemoveLeading(first, size);
    return;
  }
  for (Index column = first + size; column < dimension_; ++column) {
    const Index target = column - size;
    auto from = Part(0, column, dimension_, 1);
    auto to = Part(0, target, dimension_, 1);
    to.topRows(first) = from.topRows(first);
    to.middleRows(first, target - first + 1) = from.middleRows(first + size, target - first + 1);
  }
  dimension_ -= size;
  for (Index column = first; column < dimension_; ++column) {
    Part(column + 1, column, dimension_ - column - 1, 1).setZero();
  }
}

void SquareRootCovariance::RemoveLeading(int first, int size) {
  // What lies before the block moves to the lower right, over it; the rest stays.
  for (int column = first - 1; column >= 0; --column) {
    Part(size, column + size, column + 1, 1) = Part(0, column, column + 1, 1);
  }
  for (int column = first + size; column < dimension_; ++column) {
    double* top = Data(0, column);
    std::copy_backward(top, top + first, top + first + size);
  }
  origin_ += size;
  leading_ -= size;
  dimension_ -= size;
}

Matrix15d SquareRootCovariance::CoreCovariance() const {
  const auto rows = factor().middleRows(leading_, kCore);
  Matrix15d covariance = Matrix15d::Zero();
  covariance.selfadjointView<Eigen::Lower>().rankUpdate(rows);
  return covariance.selfadjointView<Eigen::Lower>();
}

Matrix6d SquareRootCovariance::PoseBlock(int row, int column) const {
  const int tail = dimension_ - std::max(row, column);
  return factor().block(row, dimension_ - tail, 6, tail) *
         factor().block(column, dimension_ - tail, 6, tail).transpose();
}

MatrixXd SquareRootCovariance::Covariance() const {
  const MatrixXd s = factor().triangularView<Eigen::Upper>();
  return s * s.transpose();
}

}  // namespace alidade
