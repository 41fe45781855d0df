#include "filter/update_kernels.h"

#include <cblas.h>
#include <lapack.h>

#include <cstddef>

namespace alidade {
namespace {

void Trmm(CBLAS_SIDE side, int rows, int cols, const double* s, int lds, double* x, int ldx) {
  cblas_dtrmm(CblasColMajor, side, CblasUpper, CblasNoTrans, CblasNonUnit, rows, cols, 1, s, lds, x, ldx);
}

void Trmm(CBLAS_SIDE side, int rows, int cols, const float* s, int lds, float* x, int ldx) {
  cblas_strmm(CblasColMajor, side, CblasUpper, CblasNoTrans, CblasNonUnit, rows, cols, 1, s, lds, x, ldx);
}

void Trsm(int rows, int cols, const double* u, int ldu, double* x, int ldx) {
  cblas_dtrsm(CblasColMajor, CblasRight, CblasUpper, CblasNoTrans, CblasNonUnit, rows, cols, 1, u, ldu, x,
              ldx);
}

void Trsm(int rows, int cols, const float* u, int ldu, float* x, int ldx) {
  cblas_strsm(CblasColMajor, CblasRight, CblasUpper, CblasNoTrans, CblasNonUnit, rows, cols, 1, u, ldu, x,
              ldx);
}

void Syrk(int n, int rows, const double* a, int lda, double beta, double* m, int ldm) {
  cblas_dsyrk(CblasColMajor, CblasUpper, CblasTrans, n, rows, 1, a, lda, beta, m, ldm);
}

void Syrk(int n, int rows, const float* a, int lda, float beta, float* m, int ldm) {
  cblas_ssyrk(CblasColMajor, CblasUpper, CblasTrans, n, rows, 1, a, lda, beta, m, ldm);
}

int Potrf(int n, double* m, int ldm) {
  int info = 0;
  LAPACK_dpotrf("U", &n, m, &ldm, &info);
  return info;
}

int Potrf(int n, float* m, int ldm) {
  int info = 0;
  LAPACK_spotrf("U", &n, m, &ldm, &info);
  return info;
}

}  // namespace

template <typename Scalar>
void UpdateKernels<Scalar>::TimesUpper(Scalar* rows, int ldr, int count, const Scalar* s, int lds, int n) {
  Trmm(CblasRight, count, n, s, lds, rows, ldr);
}

template <typename Scalar>
void UpdateKernels<Scalar>::AddGram(const Scalar* a, int lda, int rows, Scalar beta, Scalar* m, int ldm,
                                    int n) {
  Syrk(n, rows, a, lda, beta, m, ldm);
}

template <typename Scalar>
bool UpdateKernels<Scalar>::Cholesky(Scalar* m, int ldm, int n) {
  return Potrf(n, m, ldm) == 0;
}

template <typename Scalar>
void UpdateKernels<Scalar>::DivideByUpper(Scalar* x, int ldx, int rows, const Scalar* u, int ldu, int n) {
  Trsm(rows, n, u, ldu, x, ldx);
}

template <typename Scalar>
void UpdateKernels<Scalar>::DivideTriangle(Scalar* s, int lds, Scalar* u, int ldu, int n) {
  // Dividend, divisor and quotient are upper triangular. By halves,
  //   [X11 X12; 0 X22] [U11 U12; 0 U22] = [S11 S12; 0 S22],
  // most of the work skips the zeros. No product of full matrices: OpenBLAS allocates for the small ones.
  constexpr int kSmall = 48;
  if (n <= kSmall) {
    Trsm(n, n, u, ldu, s, lds);
    return;
  }
  const int head = n / 2;
  const int tail = n - head;
  DivideTriangle(s, lds, u, ldu, head);
  Scalar* s12 = s + static_cast<std::ptrdiff_t>(head) * lds;
  Scalar* u12 = u + static_cast<std::ptrdiff_t>(head) * ldu;
  Trmm(CblasLeft, head, tail, s, lds, u12, ldu);
  for (int column = 0; column < tail; ++column) {
    Scalar* to = s12 + static_cast<std::ptrdiff_t>(column) * lds;
    const Scalar* less = u12 + static_cast<std::ptrdiff_t>(column) * ldu;
    for (int row = 0; row < head; ++row) {
      to[row] -= less[row];
    }
  }
  Trsm(head, tail, u12 + head, ldu, s12, lds);
  DivideTriangle(s12 + head, lds, u12 + head, ldu, tail);
}

template struct UpdateKernels<double>;
template struct UpdateKernels<float>;

}  // namespace alidade
