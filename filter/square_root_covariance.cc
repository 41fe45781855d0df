#include "filter/square_root_covariance.h"

#include <cblas.h>
#include <lapack.h>

#include <algorithm>
#include <cmath>

#include "core/check.h"

namespace alidade {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Makes the leading `size` rows of [square | extra] upper triangular in `square` by Householder reflections
/// from the right, bottom row first; rows [0, size) of both blocks take part, `extra` ends as zero (and is
/// not written back). square: size x size, zero below its diagonal already where `triangular` says so.
void FoldColumns(Eigen::Ref<MatrixXd> square, Eigen::Ref<MatrixXd> extra, VectorXd* scratch) {
  const Index size = square.rows();
  const Index width = extra.cols();
  for (Index row = size - 1; row >= 0; --row) {
    const double pivot = square(row, row);
    const double extra_norm2 = extra.row(row).squaredNorm();
    if (extra_norm2 == 0) {
      continue;
    }
    const double norm = std::sqrt(pivot * pivot + extra_norm2);
    const double alpha = pivot > 0 ? -norm : norm;
    const double v0 = pivot - alpha;
    const double scale = -1.0 / (alpha * v0);
    // w = [square.col(row) | extra] v over rows 0..row, then subtract scale w v^T.
    auto w = scratch->head(row + 1);
    w = v0 * square.col(row).head(row + 1);
    for (Index k = 0; k < width; ++k) {
      w += extra(row, k) * extra.col(k).head(row + 1);
    }
    w *= scale;
    square.col(row).head(row + 1) -= v0 * w;
    for (Index k = 0; k < width; ++k) {
      const double v = extra(row, k);
      extra.col(k).head(row + 1) -= v * w;
    }
  }
}

/// Upper-triangular U with U U^T = B B^T for a small dense B (rows <= cols); U is rows x rows.
template <int kRows, int kCols>
Eigen::Matrix<double, kRows, kRows> UpperFactor(Eigen::Matrix<double, kRows, kCols> b) {
  static_assert(kCols >= kRows);
  constexpr int kOffset = kCols - kRows;
  for (int row = kRows - 1; row >= 0; --row) {
    const int last = kOffset + row;  // the pivot column of this row
    const double below2 = b.row(row).head(last).squaredNorm();
    if (below2 == 0) {
      continue;
    }
    const double pivot = b(row, last);
    const double norm = std::sqrt(below2 + pivot * pivot);
    const double alpha = pivot > 0 ? -norm : norm;
    Eigen::Matrix<double, 1, kCols> v = b.row(row);
    v[last] = pivot - alpha;
    const double scale = -1.0 / (alpha * v[last]);
    for (int above = 0; above < row; ++above) {
      const double dot = scale * b.row(above).head(last + 1).dot(v.head(last + 1));
      b.row(above).head(last + 1) -= dot * v.head(last + 1);
    }
    b.row(row).head(last).setZero();
    b(row, last) = alpha;
  }
  return b.template rightCols<kRows>().template triangularView<Eigen::Upper>();
}

}  // namespace

bool SemiDefiniteCholesky(const Matrix15d& matrix, Matrix15d* lower) {
  lower->setZero();
  for (int j = 0; j < 15; ++j) {
    const double pivot = matrix(j, j) - lower->row(j).head(j).squaredNorm();
    const double rounding = 1e-13 * std::abs(matrix(j, j));
    if (!std::isfinite(pivot) || pivot < -1e-6 * std::abs(matrix(j, j)) - 1e-300) {
      return false;
    }
    if (pivot <= rounding) {
      continue;
    }
    const double root = std::sqrt(pivot);
    (*lower)(j, j) = root;
    for (int i = j + 1; i < 15; ++i) {
      (*lower)(i, j) = (matrix(i, j) - lower->row(i).head(j).dot(lower->row(j).head(j))) / root;
    }
  }
  return true;
}

SquareRootCovariance::SquareRootCovariance(int capacity)
    : factor_(MatrixXd::Zero(capacity, capacity)),
      information_(MatrixXd::Zero(capacity, capacity)),
      projected_(VectorXd::Zero(capacity)),
      reflection_(VectorXd::Zero(capacity)) {
  CHECK_GE(capacity, kCore);
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
  factor_.topLeftCorner<kCore, kCore>() = UpperFactor<kCore, kCore>(lower);
  return Status::Ok();
}

void SquareRootCovariance::Propagate(const Matrix15d& phi, const Matrix15d& q) {
  Matrix15d noise;
  CHECK(SemiDefiniteCholesky(q, &noise)) << "process noise is not positive semi-definite";
  Eigen::Matrix<double, kCore, 2 * kCore> stacked;
  stacked.leftCols<kCore>() = noise;
  stacked.rightCols<kCore>().noalias() =
      phi * factor_.topLeftCorner<kCore, kCore>().triangularView<Eigen::Upper>().toDenseMatrix();
  factor_.topLeftCorner<kCore, kCore>() = UpperFactor<kCore, 2 * kCore>(stacked);
  for (Index column = kCore; column < dimension_; ++column) {
    const Vector15d cross = factor_.col(column).head<kCore>();
    factor_.col(column).head<kCore>().noalias() = phi * cross;
  }
}

void SquareRootCovariance::CloneCore(int first, int size) {
  CHECK(first >= 0 && first + size <= kCore);
  CHECK_LE(dimension_ + size, capacity());
  // Make room after the core block, last column first so that nothing is overwritten unread.
  for (Index column = dimension_ - 1; column >= kCore; --column) {
    const Index target = column + size;
    const Index tail = column - kCore + 1;
    factor_.col(target).segment(kCore + size, tail) = factor_.col(column).segment(kCore, tail);
    factor_.col(target).head(kCore) = factor_.col(column).head(kCore);
    factor_.col(target).segment(kCore, size) = factor_.col(target).segment(first, size);
    factor_.col(target).segment(target + 1, dimension_ + size - target - 1).setZero();
  }
  // The corner [S_II ; copied rows] has `size` more rows than columns: restore its triangle.
  const Index corner = kCore + size;
  using Corner = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 2 * kCore, 2 * kCore>;
  Corner square = Corner::Zero(corner, corner);
  Corner extra = Corner::Zero(corner, kCore);
  extra.topRows(kCore) = factor_.topLeftCorner(kCore, kCore).triangularView<Eigen::Upper>();
  extra.bottomRows(size) = extra.middleRows(first, size);
  FoldColumns(square, extra, &reflection_);
  factor_.topLeftCorner(corner, corner) = square;
  dimension_ += size;
}

void SquareRootCovariance::Remove(int first, int size) {
  CHECK(first >= kCore && first + size <= dimension_);
  // Without its rows, the block's columns are surplus for the rows above: fold them into the triangle there.
  FoldColumns(factor_.topLeftCorner(first, first), factor_.block(0, first, first, size), &reflection_);
  for (Index column = first + size; column < dimension_; ++column) {
    const Index target = column - size;
    factor_.col(target).head(first) = factor_.col(column).head(first);
    factor_.col(target).segment(first, target - first + 1) =
        factor_.col(column).segment(first + size, target - first + 1);
  }
  dimension_ -= size;
  for (Index column = first; column < dimension_; ++column) {
    factor_.col(column).segment(column + 1, dimension_ - column - 1).setZero();
  }
}

void SquareRootCovariance::Prepare(Eigen::Ref<MatrixXd> rows_in_place) const {
  CHECK_EQ(rows_in_place.cols(), dimension_);
  cblas_dtrmm(CblasColMajor, CblasRight, CblasUpper, CblasNoTrans, CblasNonUnit,
              static_cast<int>(rows_in_place.rows()), dimension_, 1.0, factor_.data(), capacity(),
              rows_in_place.data(), static_cast<int>(rows_in_place.outerStride()));
}

bool SquareRootCovariance::Apply(const Eigen::Ref<const MatrixXd>& prepared_rows,
                                 const Eigen::Ref<const VectorXd>& y, VectorXd* correction, double* nis) {
  const int rows = static_cast<int>(prepared_rows.rows());
  const int lda = static_cast<int>(prepared_rows.outerStride());
  const int n = dimension_;
  // Leading columns are zero when the rows see no core error; the corresponding part of M is the identity.
  int first = 0;
  while (first < n && prepared_rows.col(first).isZero(0)) {
    ++first;
  }
  const int active = n - first;
  correction->setZero(n);
  if (nis != nullptr) {
    *nis = y.squaredNorm();
  }
  if (active == 0) {
    return true;
  }
  const double* a = prepared_rows.data() + static_cast<Index>(first) * lda;
  double* m = information_.data();
  const int ldm = capacity();
  cblas_dsyrk(CblasColMajor, CblasUpper, CblasTrans, active, rows, 1.0, a, lda, 0.0, m, ldm);
  auto diagonal = information_.diagonal().head(active);
  if (!diagonal.allFinite() || !y.allFinite()) {
    return false;
  }
  diagonal.array() += 1.0;
  int info = 0;
  LAPACK_dpotrf("U", &active, m, &ldm, &info);
  CHECK_EQ(info, 0) << "I + A^T A of finite rows lost positivity";
  cblas_dtrsm(CblasColMajor, CblasRight, CblasUpper, CblasNoTrans, CblasNonUnit, n, active, 1.0, m, ldm,
              factor_.data() + static_cast<Index>(first) * capacity(), capacity());
  auto b = projected_.head(active);
  cblas_dgemv(CblasColMajor, CblasTrans, rows, active, 1.0, a, lda, y.data(), 1, 0.0, b.data(), 1);
  cblas_dtrsv(CblasColMajor, CblasUpper, CblasTrans, CblasNonUnit, active, m, ldm, b.data(), 1);
  correction->noalias() = factor_.block(0, first, n, active) * b;
  if (nis != nullptr) {
    *nis -= b.squaredNorm();
  }
  return true;
}

Matrix15d SquareRootCovariance::CoreCovariance() const {
  const auto rows = factor_.topLeftCorner(kCore, dimension_);
  Matrix15d covariance = Matrix15d::Zero();
  covariance.selfadjointView<Eigen::Lower>().rankUpdate(rows);
  return covariance.selfadjointView<Eigen::Lower>();
}

Matrix6d SquareRootCovariance::PoseBlock(int row, int column) const {
  const int tail = dimension_ - std::max(row, column);
  return factor_.block(row, dimension_ - tail, 6, tail) *
         factor_.block(column, dimension_ - tail, 6, tail).transpose();
}

MatrixXd SquareRootCovariance::Covariance() const {
  const MatrixXd s = factor().triangularView<Eigen::Upper>();
  return s * s.transpose();
}

}  // namespace alidade
