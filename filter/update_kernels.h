#pragma once

namespace alidade {

/// The products and factorisations of SquareRootCovariance's update, in double or in single precision.
/// Matrices are column-major; the integer after one is its leading dimension. None allocates.
template <typename Scalar>
struct UpdateKernels {
  /// rows (count x n) <- rows S, S upper triangular.
  static void TimesUpper(Scalar* rows, int ldr, int count, const Scalar* s, int lds, int n);
  /// Upper triangle of M (n x n) <- beta M + A^T A; A: rows x n.
  static void AddGram(const Scalar* a, int lda, int rows, Scalar beta, Scalar* m, int ldm, int n);
  /// M = U^T U in the upper triangle. False when M is not positive definite.
  [[nodiscard]] static bool Cholesky(Scalar* m, int ldm, int n);
  /// X (rows x n) <- X U^-1.
  static void DivideByUpper(Scalar* x, int ldx, int rows, const Scalar* u, int ldu, int n);
  /// S <- S U^-1, both upper triangular (n x n); overwrites U above its diagonal blocks.
  static void DivideTriangle(Scalar* s, int lds, Scalar* u, int ldu, int n);
};

extern template struct UpdateKernels<double>;
extern template struct UpdateKernels<float>;

}  // namespace alidade
