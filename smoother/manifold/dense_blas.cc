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
  constexpr int kBlock = 32;
  const int height = Size(rows->rows());
  const int width = Size(rows->cols());
  const int stride = Stride(*rows);
  const int work_size = kBlock * width;
  Eigen::VectorXd tau(width);
  Eigen::VectorXd work(work_size);
  int info = 0;
  LAPACK_dgeqrf(&height, &width, rows->data(), &stride, tau.data(), work.data(), &work_size, &info);
}

}  // namespace alidade
