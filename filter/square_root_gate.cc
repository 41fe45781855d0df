#include <cblas.h>
#include <lapack.h>

#include <Eigen/LU>
#include <limits>

#include "filter/square_root_covariance.h"

// Blocks of prepared rows on their own, as the gate sees them.

namespace alidade {

using Eigen::Index;

double SquareRootCovariance::NormalizedInnovationSquared(const PreparedRows& prepared, int first, int count,
                                                         double noise_variance) {
  const auto y = prepared.innovation_.segment(first, count);
  const Index rows = count;
  if (rows == 2) {  // a remembered track or a landmark of the state: too small for BLAS
    const auto pair = prepared.rows_.middleRows<2>(first);
    const Eigen::Matrix2d variance =
        pair.lazyProduct(pair.transpose()) + noise_variance * Eigen::Matrix2d::Identity();
    const Eigen::Vector2d innovation = y;
    return innovation.dot(variance.inverse() * innovation);
  }
  if (!FactorInnovation(prepared, first, count, noise_variance)) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  return gated_.head(rows).squaredNorm();
}

bool SquareRootCovariance::FactorInnovation(const PreparedRows& prepared, int first, int count,
                                            double noise_variance) {
  const auto a = prepared.rows_.middleRows(first, count);
  if (gate_.rows() < count) {
    gate_.resize(count, count);
    gated_.resize(count);
  }
  const int ld = static_cast<int>(gate_.rows());
  cblas_dsyrk(CblasColMajor, CblasLower, CblasNoTrans, count, dimension_, 1.0, a.data(),
              static_cast<int>(a.outerStride()), 0.0, gate_.data(), ld);
  gate_.diagonal().head(count).array() += noise_variance;
  gated_.head(count) = prepared.innovation_.segment(first, count);
  int info = 0;
  LAPACK_dpotrf("L", &count, gate_.data(), &ld, &info);
  if (info != 0) {
    return false;
  }
  cblas_dtrsv(CblasColMajor, CblasLower, CblasNoTrans, CblasNonUnit, count, gate_.data(), ld, gated_.data(),
              1);
  return true;
}

bool SquareRootCovariance::Whiten(const PreparedRows& prepared, int first, int count, double noise_variance,
                                  Eigen::Ref<Eigen::MatrixXd> maps, Eigen::Ref<Eigen::VectorXd> innovation) {
  if (!FactorInnovation(prepared, first, count, noise_variance)) {
    return false;
  }
  innovation = gated_.head(count);
  cblas_dtrsm(CblasColMajor, CblasLeft, CblasLower, CblasNoTrans, CblasNonUnit, count,
              static_cast<int>(maps.cols()), 1.0, gate_.data(), static_cast<int>(gate_.rows()), maps.data(),
              static_cast<int>(maps.outerStride()));
  return true;
}

}  // namespace alidade
