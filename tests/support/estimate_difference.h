#pragma once

#include <Eigen/Cholesky>

#include "core/error_convention.h"

namespace alidade::test {

/// Largest entry of a - b, whitened by b.
inline double RelativeDifference(const Matrix15d& a, const Matrix15d& b) {
  const Eigen::LLT<Matrix15d> factor(b);
  const Matrix15d half = factor.matrixL().solve(a - b);
  return factor.matrixL().solve(half.transpose()).cwiseAbs().maxCoeff();
}

/// Distance of the means in standard deviations of b.
inline double MeanDifference(const NavEstimate& a, const NavEstimate& b) {
  Vector15d difference;
  difference << Local(ErrorConvention::kSo3xRn, b.nav, a.nav), a.bias.gyro - b.bias.gyro,
      a.bias.accel - b.bias.accel;
  return b.covariance.llt().matrixL().solve(difference).norm();
}

}  // namespace alidade::test
