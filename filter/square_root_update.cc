#include <cblas.h>
#include <lapack.h>

#include <algorithm>
#include <limits>

#include "core/check.h"
#include "filter/square_root_covariance.h"
#include "filter/update_kernels.h"

// The Kalman update of SquareRootCovariance.

namespace alidade {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Largest diagonal of A^T A, beside the identity, in single precision: it then holds the identity to 1e-3.
constexpr float kLargestInSingle = 1e4F;

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
  const int active = dimension_ - first;
  if (active > 0 && UsesSingle()) {
    auto single = SingleRows(rows.topRows(dense), active);
    UpdateKernels<float>::TimesUpper(single.data(), static_cast<int>(single.outerStride()), dense,
                                     SingleFactor(first), capacity(), active);
    rows.topRows(dense).rightCols(active) = single.cast<double>();
  } else if (active > 0) {
    UpdateKernels<double>::TimesUpper(rows.data() + first * rows.outerStride(),
                                      static_cast<int>(rows.outerStride()), dense, Data(first, first),
                                      capacity(), active);
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

template <typename Scalar>
bool SquareRootCovariance::FactorInformation(const Scalar* rows, int lda, const SeenColumns& seen, int count,
                                             Scalar largest, Eigen::Matrix<Scalar, -1, -1>* information) {
  using Kernels = UpdateKernels<Scalar>;
  const int first = seen.first();
  const auto accumulate = [&](int row, int end, int from, Scalar beta) {
    Scalar* m = information->data() + static_cast<Index>(from - first) * (capacity() + 1);
    Kernels::AddGram(rows + row + static_cast<Index>(from - first) * lda, lda, end - row, beta, m, capacity(),
                     dimension_ - from);
  };
  // The wider part first: it overwrites.
  if (seen.dense <= seen.sparse) {
    accumulate(0, seen.sparse_from, seen.dense, 0);
    accumulate(seen.sparse_from, count, seen.sparse, 1);
  } else {
    accumulate(seen.sparse_from, count, seen.sparse, 0);
    accumulate(0, seen.sparse_from, seen.dense, 1);
  }
  const int active = dimension_ - first;
  auto diagonal = information->diagonal().head(active);
  if (!diagonal.allFinite() || diagonal.maxCoeff() > largest) {
    return false;
  }
  diagonal.array() += 1;
  return Kernels::Cholesky(information->data(), capacity(), active);
}

bool SquareRootCovariance::FactorInSingle(const Eigen::Ref<const MatrixXd>& rows, const SeenColumns& seen) {
  const Index active = dimension_ - seen.first();
  const auto single = SingleRows(rows, active);
  if (!FactorInformation<float>(single.data(), static_cast<int>(single.outerStride()), seen,
                                static_cast<int>(rows.rows()), kLargestInSingle, &single_information_)) {
    return false;
  }
  for (Index column = 0; column < active; ++column) {
    information_.col(column).head(column + 1) =
        single_information_.col(column).head(column + 1).cast<double>();
  }
  return true;
}

Eigen::Ref<Eigen::MatrixXf> SquareRootCovariance::SingleRows(const Eigen::Ref<const MatrixXd>& rows,
                                                             Index active) {
  if (single_rows_.rows() < rows.rows()) {
    single_rows_.resize(std::max(rows.rows(), 2 * single_rows_.rows()), capacity());
  }
  auto single = single_rows_.topLeftCorner(rows.rows(), active);
  single = rows.rightCols(active).cast<float>();
  return single;
}

float* SquareRootCovariance::SingleFactor(int first) {
  for (int column = first; column < dimension_; ++column) {
    const int rows = column - first + 1;
    auto single = single_factor_.col(column - first).head(dimension_ - first);
    single.head(rows) = Part(first, column, rows, 1).cast<float>();
    single.tail(single.size() - rows).setZero();
  }
  return single_factor_.data();
}

void SquareRootCovariance::DivideByInformationRoot(int first) {
  const int active = dimension_ - first;
  const int ld = capacity();
  if (!in_single_) {
    using Kernels = UpdateKernels<double>;
    Kernels::DivideByUpper(Data(0, first), ld, first, information_.data(), ld, active);
    Kernels::DivideTriangle(Data(first, first), ld, information_.data(), ld, active);
    return;
  }
  using Kernels = UpdateKernels<float>;
  if (first > 0) {
    auto above = single_factor_.topLeftCorner(first, active);
    above = Part(0, first, first, active).cast<float>();
    Kernels::DivideByUpper(above.data(), ld, first, single_information_.data(), ld, active);
    Part(0, first, first, active) = above.cast<double>();
  }
  Kernels::DivideTriangle(SingleFactor(first), ld, single_information_.data(), ld, active);
  for (int column = first; column < dimension_; ++column) {
    const int rows = column - first + 1;
    Part(first, column, rows, 1) = single_factor_.col(column - first).head(rows).cast<double>();
  }
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
  const int dense = prepared.sparse_from_;
  // Where the rows see nothing, the corresponding part of M is the identity.
  const SeenColumns seen{LeadingZeroColumns(prepared_rows.topRows(dense)),
                         LeadingZeroColumns(prepared_rows.bottomRows(rows - dense)), dense};
  const int first = seen.first();
  const int active = dimension_ - first;
  factored_ = first;
  in_single_ = false;
  if (nis != nullptr) {
    *nis = y.squaredNorm();
  }
  if (log_det != nullptr) {
    *log_det = 0;
  }
  if (active == 0) {
    return true;
  }
  if (!y.allFinite()) {
    return false;
  }
  const double* a = prepared_rows.data() + static_cast<Index>(first) * lda;
  in_single_ = UsesSingle() && FactorInSingle(prepared_rows, seen);
  if (!in_single_ && !FactorInformation<double>(a, lda, seen, rows, std::numeric_limits<double>::infinity(),
                                                &information_)) {
    return false;
  }
  const auto diagonal = information_.diagonal().head(active);
  double* m = information_.data();
  const int ldm = capacity();
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
