#include "smoother/manifold/dense_blas.h"

#include <cblas.h>
#include <lapack.h>

#include <algorithm>

#include "core/blas.h"

namespace alidade {
namespace {

int Size(Eigen::Index size) {
  return static_cast<int>(size);
}
int Stride(const Eigen::MatrixXd& matrix) {
  return std::max(1, static_cast<int>(matrix.outerStride()));
}

/// The last row with an entry in `count` columns from `first` on; -1 where they are zero.
int LastNonzeroRow(const Eigen::MatrixXd& matrix, int first, int count) {
  Eigen::Index last = -1;
  for (Eigen::Index column = first; column < first + count; ++column) {
    Eigen::Index row = matrix.rows() - 1;
    while (row > last && matrix(row, column) == 0) {
      --row;
    }
    last = row;
  }
  return static_cast<int>(last);
}

}  // namespace

void FormGram(const Eigen::MatrixXd& rows, Eigen::MatrixXd* gram) {
  UseOneThreadPerBlasCall();
  gram->setZero(rows.cols(), rows.cols());
  cblas_dsyrk(CblasColMajor, CblasLower, CblasTrans, Size(rows.cols()), Size(rows.rows()), 1.0, rows.data(),
              Stride(rows), 0.0, gram->data(), Stride(*gram));
}

void SubtractGram(const Eigen::MatrixXd& rows, Eigen::MatrixXd* hessian) {
  UseOneThreadPerBlasCall();
  cblas_dsyrk(CblasColMajor, CblasLower, CblasTrans, Size(rows.cols()), Size(rows.rows()), -1.0, rows.data(),
              Stride(rows), 1.0, hessian->data(), Stride(*hessian));
}

bool FactorLower(Eigen::MatrixXd* matrix) {
  UseOneThreadPerBlasCall();
  const int size = Size(matrix->rows());
  const int stride = Stride(*matrix);
  int info = 0;
  LAPACK_dpotrf("L", &size, matrix->data(), &stride, &info);
  return info == 0;
}

void SolveLower(const Eigen::MatrixXd& lower, Eigen::Ref<Eigen::MatrixXd> right) {
  UseOneThreadPerBlasCall();
  cblas_dtrsm(CblasColMajor, CblasLeft, CblasLower, CblasNoTrans, CblasNonUnit, Size(right.rows()),
              Size(right.cols()), 1.0, lower.data(), Stride(lower), right.data(), Size(right.outerStride()));
}

void SolveUpperTransposed(const Eigen::MatrixXd& upper, Eigen::Ref<Eigen::MatrixXd> right) {
  UseOneThreadPerBlasCall();
  cblas_dtrsm(CblasColMajor, CblasLeft, CblasUpper, CblasTrans, CblasNonUnit, Size(right.rows()),
              Size(right.cols()), 1.0, upper.data(), Stride(upper), right.data(), Size(right.outerStride()));
}

void SolveCholesky(const Eigen::MatrixXd& lower, Eigen::VectorXd* right) {
  UseOneThreadPerBlasCall();
  for (const CBLAS_TRANSPOSE transpose : {CblasNoTrans, CblasTrans}) {
    cblas_dtrsv(CblasColMajor, CblasLower, transpose, CblasNonUnit, Size(right->size()), lower.data(),
                Stride(lower), right->data(), 1);
  }
}

void Triangularize(Eigen::MatrixXd* rows) {
  UseOneThreadPerBlasCall();
  constexpr int kPanel = 12;
  const int height = Size(rows->rows());
  const int width = Size(rows->cols());
  const int stride = Stride(*rows);
  Eigen::MatrixXd reflectors(kPanel, kPanel);
  Eigen::VectorXd tau(kPanel);
  Eigen::VectorXd work(static_cast<Eigen::Index>(kPanel) * std::max(1, width));
  int end = 0;  // of the rows that are not zero up to the panel
  int info = 0;
  for (int column = 0; column < std::min(height, width); column += kPanel) {
    const int panel = std::min(kPanel, width - column);
    end = std::max({end, LastNonzeroRow(*rows, column, panel) + 1, std::min(column + panel, height)});
    const int active = end - column;
    const int order = std::min(active, panel);
    double* diagonal = rows->data() + column + static_cast<Eigen::Index>(column) * stride;
    LAPACK_dgeqr2(&active, &panel, diagonal, &stride, tau.data(), work.data(), &info);
    const int right = width - column - panel;
    if (right > 0) {
      double* beside = diagonal + static_cast<Eigen::Index>(panel) * stride;
      LAPACK_dlarft("F", "C", &active, &order, diagonal, &stride, tau.data(), reflectors.data(), &kPanel);
      LAPACK_dlarfb("L", "T", "F", "C", &active, &right, &order, diagonal, &stride, reflectors.data(),
                    &kPanel, beside, &stride, work.data(), &right);
    }
  }
}

}  // namespace alidade
