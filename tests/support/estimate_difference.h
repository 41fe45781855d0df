#pragma once

#include <Eigen/Cholesky>

#include "core/calibration.h"
#include "core/clock_state.h"
#include "core/error_convention.h"

namespace alidade::test {

/// Largest entry of a - b, whitened by b.
template <typename A, int N>
double RelativeDifference(const Eigen::MatrixBase<A>& a, const Eigen::Matrix<double, N, N>& b) {
  using Matrix = Eigen::Matrix<double, N, N>;
  const Eigen::LLT<Matrix> factor(b);
  const Matrix half = factor.matrixL().solve(a - b);
  return factor.matrixL().solve(half.transpose()).cwiseAbs().maxCoeff();
}

/// Whether all numbers are the same.
inline bool AreSame(const NavEstimate& a, const NavEstimate& b) {
  return a.stamp_ns == b.stamp_ns && a.nav.R_WB == b.nav.R_WB && a.nav.p_WB == b.nav.p_WB &&
         a.nav.v_WB == b.nav.v_WB && a.bias.gyro == b.bias.gyro && a.bias.accel == b.bias.accel &&
         a.covariance == b.covariance;
}

/// Distance of the means in standard deviations of b.
inline double MeanDifference(const NavEstimate& a, const NavEstimate& b) {
  Vector15d difference;
  difference << Local(ErrorConvention::kSo3xRn, b.nav, a.nav), a.bias.gyro - b.bias.gyro,
      a.bias.accel - b.bias.accel;
  return b.covariance.llt().matrixL().solve(difference).norm();
}

/// The same of a receiver's clock.
inline double MeanDifference(const ClockState& a, const ClockState& b) {
  return b.covariance.llt().matrixL().solve(a.mean - b.mean).norm();
}

/// The same of a camera, each of its coordinates by its own deviation.
inline double MeanDifference(const CalibrationEstimate& a, const CalibrationEstimate& b) {
  return Local(b.layout, b.mean, a.mean).cwiseQuotient(b.deviations).norm();
}

}  // namespace alidade::test
