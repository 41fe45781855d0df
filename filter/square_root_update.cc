#include <cblas.h>
#include <lapack.h>

#include <Eigen/LU>
#include <algorithm>
#include <limits>

#include "core/check.h"
#include "filter/square_root_covariance.h"

// The Kalman update of SquareRootCovariance.

namespace alidade {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

int LeadingZeroColumns(const Eigen::Ref<const MatrixXd>& matrix) {
  int first = 0;
  while (first < matrix.cols() && matrix.col(first).isZero(0)) {
    ++first;
  }
  return first;
}

}  // namespace

PreparedRows SquareRootCovariance::Prepare(Eigen::Ref<MatrixXd> rows, Eigen::Ref<VectorXd> innovation,
                                           int sparse_from) {
  CHECK_EQ(rows.cols(), dimension_);
  CHECK_EQ(rows.rows(), innovation.size());
  const int count = static_cast<int>(rows.rows());
  const int dense = sparse_from < 0 ? count : sparse_from;
  const int first = LeadingZeroColumns(rows.topRows(dense));
  if (first < dimension_) {
    cblas_dtrmm(CblasColMajor, CblasRight, CblasUpper, CblasNoTrans, CblasNonUnit, dense, dimension_ - first,
                1.0, Data(first, first), capacity(), rows.data() + first * rows.outerStride(),
                static_cast<int>(rows.outerStride()));
  }
  if (dense < count) {
    PrepareSparse(rows.bottomRows(count - dense));
  }
  return PreparedRows(rows, innovation, dense);
}

void SquareRootCovariance::PrepareSparse(Eigen::Ref<MatrixXd> rows_in_place) {
  entries_.clear();
  row_ends_.clear();
  for (Index row = 0; row < rows_in_place.rows(); ++row) {
    for (int column = 0; column < dimension_; ++column) {
      const double value = rows_in_place(row, column);
      if (value != 0) {
        entries_.emplace_back(column, value);
      }
    }
    row_ends_.push_back(entries_.size());
  }
  for (int column = 0; column < dimension_; ++column) {
    const double* s = Data(0, column);  // zero below its diagonal
    size_t entry = 0;
    for (Index row = 0; row < rows_in_place.rows(); ++row) {
      double sum = 0;
      for (const size_t end = row_ends_[static_cast<size_t>(row)]; entry < end; ++entry) {
        sum += entries_[entry].second * s[entries_[entry].first];
      }
      rows_in_place(row, column) = sum;
    }
  }
}

double SquareRootCovariance::NormalizedInnovationSquared(const PreparedRows& prepared, int first, int count,
                                                         double noise_variance) {
  const auto a = prepared.rows_.middleRows(first, count);
  const auto y = prepared.innovation_.segment(first, count);
  const Index rows = count;
  if (rows == 2) {  // a remembered track or a landmark of the state: too small for BLAS
    const auto pair = prepared.rows_.middleRows<2>(first);
    const Eigen::Matrix2d variance =
        pair.lazyProduct(pair.transpose()) + noise_variance * Eigen::Matrix2d::Identity();
    const Eigen::Vector2d innovation = y;
    return innovation.dot(variance.inverse() * innovation);
  }
  if (gate_.rows() < rows) {
    gate_.resize(rows, rows);
    gated_.resize(rows);
  }
  const int n = static_cast<int>(rows);
  const int ld = static_cast<int>(gate_.rows());
  cblas_dsyrk(CblasColMajor, CblasLower, CblasNoTrans, n, dimension_, 1.0, a.data(),
              static_cast<int>(a.outerStride()), 0.0, gate_.data(), ld);
  gate_.diagonal().head(rows).array() += noise_variance;
  gated_.head(rows) = y;
  int info = 0;
  LAPACK_dpotrf("L", &n, gate_.data(), &ld, &info);
  if (info != 0) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  cblas_dtrsv(CblasColMajor, CblasLower, CblasNoTrans, CblasNonUnit, n, gate_.data(), ld, gated_.data(), 1);
  return gated_.head(rows).squaredNorm();
}

void SquareRootCovariance::FormInformation(const Eigen::Ref<const MatrixXd>& rows, int sparse_from,
                                           int first_dense, int first_sparse) {
  const int lda = static_cast<int>(rows.outerStride());
  const int first = std::min(first_dense, first_sparse);
  const int count = static_cast<int>(rows.rows());
  const auto accumulate = [&](int row, int end, int from, double beta) {
    double* m = information_.data() + static_cast<Index>(from - first) * (capacity() + 1);
    cblas_dsyrk(CblasColMajor, CblasUpper, CblasTrans, dimension_ - from, end - row, 1.0,
                rows.data() + row + static_cast<Index>(from) * lda, lda, beta, m, capacity());
  };
  // The wider part first: it overwrites.
  if (first_dense <= first_sparse) {
    accumulate(0, sparse_from, first_dense, 0.0);
    accumulate(sparse_from, count, first_sparse, 1.0);
  } else {
    accumulate(sparse_from, count, first_sparse, 0.0);
    accumulate(0, sparse_from, first_dense, 1.0);
  }
}

void SquareRootCovariance::DivideByInformationRoot(int first) {
  const int active = dimension_ - first;
  const double* u = information_.data();
  if (first > 0) {
    cblas_dtrsm(CblasColMajor, CblasRight, CblasUpper, CblasNoTrans, CblasNonUnit, first, active, 1.0, u,
                capacity(), Data(0, first), capacity());
  }
  DivideTriangle(first, 0, active);
}

void SquareRootCovariance::DivideTriangle(int first, int begin, int size) {
  // Dividend, divisor and quotient are upper triangular. By halves,
  //   [X11 X12; 0 X22] [U11 U12; 0 U22] = [S11 S12; 0 S22],
  // most of the work skips the zeros. No product of full matrices: OpenBLAS allocates for the small ones.
  constexpr int kSmall = 48;
  double* s = Data(first + begin, first + begin);
  double* u = information_.data() + static_cast<Index>(begin) * (capacity() + 1);
  if (size <= kSmall) {
    cblas_dtrsm(CblasColMajor, CblasRight, CblasUpper, CblasNoTrans, CblasNonUnit, size, size, 1.0, u,
                capacity(), s, capacity());
    return;
  }
  const int head = size / 2;
  const int tail = size - head;
  DivideTriangle(first, begin, head);
  const Index corner = static_cast<Index>(head) * capacity();
  cblas_dtrmm(CblasColMajor, CblasLeft, CblasUpper, CblasNoTrans, CblasNonUnit, head, tail, 1.0, s,
              capacity(), u + corner, capacity());
  Part(first + begin, first + begin + head, head, tail) -=
      information_.block(begin, begin + head, head, tail);
  cblas_dtrsm(CblasColMajor, CblasRight, CblasUpper, CblasNoTrans, CblasNonUnit, head, tail, 1.0,
              u + corner + head, capacity(), s + corner, capacity());
  DivideTriangle(first, begin + head, tail);
}

bool SquareRootCovariance::Apply(const PreparedRows& prepared, Eigen::Ref<VectorXd> correction, double* nis,
                                 double* log_det) {
  correction.setZero();
  if (!Factor(prepared, nis, log_det)) {
    return false;
  }
  Commit(correction);
  return true;
}

bool SquareRootCovariance::Factor(const PreparedRows& prepared, double* nis, double* log_det) {
  const Eigen::Ref<MatrixXd>& prepared_rows = prepared.rows_;
  const Eigen::Ref<VectorXd>& y = prepared.innovation_;
  const int rows = static_cast<int>(prepared_rows.rows());
  const int lda = static_cast<int>(prepared_rows.outerStride());
  const int n = dimension_;
  const int dense = prepared.sparse_from_;
  // Where the rows see nothing, the corresponding part of M is the identity.
  const int first_dense = LeadingZeroColumns(prepared_rows.topRows(dense));
  const int first_sparse = LeadingZeroColumns(prepared_rows.bottomRows(rows - dense));
  const int first = std::min(first_dense, first_sparse);
  const int active = n - first;
  factored_ = first;
  if (nis != nullptr) {
    *nis = y.squaredNorm();
  }
  if (log_det != nullptr) {
    *log_det = 0;
  }
  if (active == 0) {
    return true;
  }
  const double* a = prepared_rows.data() + static_cast<Index>(first) * lda;
  double* m = information_.data();
  const int ldm = capacity();
  FormInformation(prepared_rows, dense, first_dense, first_sparse);
  auto diagonal = information_.diagonal().head(active);
  if (!diagonal.allFinite() || !y.allFinite()) {
    return false;
  }
  diagonal.array() += 1.0;
  int info = 0;
  LAPACK_dpotrf("U", &active, m, &ldm, &info);
  if (info != 0) {
    return false;
  }
  if (log_det != nullptr) {
    *log_det = 2 * diagonal.array().log().sum();
  }
  auto b = projected_.head(active);
  cblas_dgemv(CblasColMajor, CblasTrans, rows, active, 1.0, a, lda, y.data(), 1, 0.0, b.data(), 1);
  cblas_dtrsv(CblasColMajor, CblasUpper, CblasTrans, CblasNonUnit, active, m, ldm, b.data(), 1);
  if (nis != nullptr) {
    *nis -= b.squaredNorm();
  }
  return true;
}

double SquareRootCovariance::Solution(Eigen::Ref<VectorXd> correction) {
  correction.setZero();
  const int active = dimension_ - factored_;
  if (active == 0) {
    whitened_.head(dimension_).setZero();
    return 0;
  }
  auto b = projected_.head(active);
  whitened_.head(factored_).setZero();
  auto w = whitened_.segment(factored_, active);
  w = b;
  cblas_dtrsv(CblasColMajor, CblasUpper, CblasNoTrans, CblasNonUnit, active, information_.data(), capacity(),
              w.data(), 1);
  correction.noalias() = Part(0, factored_, dimension_, active) * w;
  // A^T A = U^T U - I.
  return b.squaredNorm() - w.squaredNorm();
}

double SquareRootCovariance::SquaredStep(const Eigen::Ref<const VectorXd>& from) {
  auto step = step_.head(dimension_);
  step = whitened_.head(dimension_) - from;
  cblas_dtrmv(CblasColMajor, CblasUpper, CblasNoTrans, CblasNonUnit, dimension_ - factored_,
              information_.data(), capacity(), step.data() + factored_, 1);
  return step.squaredNorm();
}

void SquareRootCovariance::Commit(Eigen::Ref<VectorXd> correction) {
  correction.setZero();
  const int active = dimension_ - factored_;
  if (active == 0) {
    return;
  }
  DivideByInformationRoot(factored_);
  correction.noalias() = Part(0, factored_, dimension_, active) * projected_.head(active);
}

}  // namespace alidade
