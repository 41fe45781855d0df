#include <cblas.h>
#include <lapack.h>

#include <algorithm>

#include "core/check.h"
#include "filter/square_root_covariance.h"

// The Kalman update of SquareRootCovariance by few rows.

namespace alidade {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// Divides the columns of S by U from left to right, a block at a time; U^T U = I + A^T A. Of the columns of
/// A passed so far it keeps T with T T^T = (I + A A^T)^-1, and Y, such that
///   S'_k = (S_k - Y A_k) U_kk^-1,   U_kk^T U_kk = I + (T^T A_k)^T (T^T A_k),
///   Y += S'_k U_kk^-T (T^T A_k)^T T^T:
/// 2 rows n^2 products in all instead of the n^3 of a factorisation of I + A^T A. At the end Y y is the
/// correction by the innovation y.
class ColumnSweep {
 public:
  static constexpr int kBlock = 32;

  ColumnSweep(int rows, int dimension)
      : rows_(rows),
        t_(MatrixXd::Identity(rows, rows)),
        y_(MatrixXd::Zero(dimension, rows)),
        root_(kBlock, kBlock),
        reduced_(rows, kBlock),
        gain_(kBlock, rows),
        whole_(rows, rows) {}

  /// The next `size` columns: `a` of A, and `s` of S, `above` of whose rows lie before its diagonal part.
  /// False when A is so large that rounding leaves nothing of I.
  bool Divide(const double* a, int size, int above, double* s, int lds) {
    if (!FactorBlock(a, size)) {
      return false;
    }
    cblas_dgemm(CblasColMajor, CblasNoTrans, CblasNoTrans, above, size, rows_, -1.0, y_.data(), Stride(), a,
                rows_, 1.0, s, lds);
    cblas_dtrsm(CblasColMajor, CblasRight, CblasUpper, CblasNoTrans, CblasNonUnit, above + size, size, 1.0,
                root_.data(), kBlock, s, lds);
    cblas_dgemm(CblasColMajor, CblasTrans, CblasTrans, size, rows_, rows_, 1.0, reduced_.data(), rows_,
                t_.data(), rows_, 0.0, gain_.data(), kBlock);
    cblas_dtrsm(CblasColMajor, CblasLeft, CblasUpper, CblasTrans, CblasNonUnit, size, rows_, 1.0,
                root_.data(), kBlock, gain_.data(), kBlock);
    cblas_dgemm(CblasColMajor, CblasNoTrans, CblasNoTrans, above + size, rows_, size, 1.0, s, lds,
                gain_.data(), kBlock, 1.0, y_.data(), Stride());
    return PassBlock(size);
  }

  [[nodiscard]] const MatrixXd& t() const { return t_; }
  [[nodiscard]] const MatrixXd& y() const { return y_; }

 private:
  [[nodiscard]] int Stride() const { return static_cast<int>(y_.rows()); }

  [[nodiscard]] bool FactorBlock(const double* a, int size) {
    cblas_dgemm(CblasColMajor, CblasTrans, CblasNoTrans, rows_, size, rows_, 1.0, t_.data(), rows_, a, rows_,
                0.0, reduced_.data(), rows_);
    root_.setIdentity();
    cblas_dsyrk(CblasColMajor, CblasUpper, CblasTrans, size, rows_, 1.0, reduced_.data(), rows_, 1.0,
                root_.data(), kBlock);
    int info = 0;
    LAPACK_dpotrf("U", &size, root_.data(), &kBlock, &info);
    return info == 0;
  }

  [[nodiscard]] bool PassBlock(int size) {
    whole_.setIdentity();
    cblas_dsyrk(CblasColMajor, CblasLower, CblasNoTrans, rows_, size, 1.0, reduced_.data(), rows_, 1.0,
                whole_.data(), rows_);
    int info = 0;
    LAPACK_dpotrf("L", &rows_, whole_.data(), &rows_, &info);
    if (info != 0) {
      return false;
    }
    cblas_dtrsm(CblasColMajor, CblasRight, CblasLower, CblasTrans, CblasNonUnit, rows_, rows_, 1.0,
                whole_.data(), rows_, t_.data(), rows_);
    return true;
  }

  int rows_;
  MatrixXd t_;
  MatrixXd y_;
  MatrixXd root_;     ///< U_kk
  MatrixXd reduced_;  ///< T^T A_k
  MatrixXd gain_;     ///< U_kk^-T (T^T A_k)^T T^T
  MatrixXd whole_;
};

}  // namespace

MatrixXd SquareRootCovariance::Block(int first, int size) const {
  CHECK(first >= 0 && first + size <= dimension_);
  const auto rows = factor().block(first, first, size, dimension_ - first);
  MatrixXd covariance(size, size);
  cblas_dsyrk(CblasColMajor, CblasLower, CblasNoTrans, size, dimension_ - first, 1.0, rows.data(), capacity(),
              0.0, covariance.data(), size);
  return covariance.selfadjointView<Eigen::Lower>();
}

bool SquareRootCovariance::UpdateByBlock(int first, const Eigen::Ref<const MatrixXd>& rows,
                                         const Eigen::Ref<const VectorXd>& y, Eigen::Ref<VectorXd> correction,
                                         double* nis, const Eigen::Ref<const MatrixXd>& constants) {
  CHECK(first >= 0 && first + rows.cols() <= dimension_);
  const int count = static_cast<int>(rows.rows());
  const int active = dimension_ - first;
  MatrixXd a(count, active);  // A = H S; S is zero below its diagonal
  cblas_dgemm(CblasColMajor, CblasNoTrans, CblasNoTrans, count, active, static_cast<int>(rows.cols()), 1.0,
              rows.data(), static_cast<int>(rows.outerStride()), Data(first, first), capacity(), 0.0,
              a.data(), count);
  if (constants.cols() > 0) {
    const Index size = constants.cols();
    a.rightCols(size).noalias() += constants * factor().bottomRightCorner(size, size);
  }
  if (!a.allFinite() || !y.allFinite()) {
    return false;
  }
  ColumnSweep sweep(count, dimension_);
  for (int begin = 0; begin < active; begin += ColumnSweep::kBlock) {
    if (!sweep.Divide(a.data() + static_cast<Index>(begin) * count,
                      std::min(ColumnSweep::kBlock, active - begin), first + begin, Data(0, first + begin),
                      capacity())) {
      return false;
    }
  }
  correction.noalias() = sweep.y() * y;
  if (nis != nullptr) {
    *nis = (sweep.t().transpose() * y).squaredNorm();
  }
  return true;
}

}  // namespace alidade
