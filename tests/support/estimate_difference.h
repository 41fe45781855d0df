#pragma once

#include <Eigen/Cholesky>
#include <bit>
#include <cstdint>

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

/// Whether all numbers have the same bits.
template <typename A, typename B>
bool EqualBits(const Eigen::MatrixBase<A>& a, const Eigen::MatrixBase<B>& b) {
  return a
      .binaryExpr(b,
                  [](double left, double right) {
                    return std::bit_cast<std::uint64_t>(left) == std::bit_cast<std::uint64_t>(right);
                  })
      .all();
}
inline bool EqualBits(const NavEstimate& a, const NavEstimate& b) {
  return a.stamp_ns == b.stamp_ns && EqualBits(a.nav.R_WB, b.nav.R_WB) && EqualBits(a.nav.p_WB, b.nav.p_WB) &&
         EqualBits(a.nav.v_WB, b.nav.v_WB) && EqualBits(a.bias.gyro, b.bias.gyro) &&
         EqualBits(a.bias.accel, b.bias.accel) && EqualBits(a.covariance, b.covariance);
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
