#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

namespace alidade {

/// Allan variance of a rate at one averaging time.
struct AllanPoint {
  std::size_t cluster = 1;  ///< samples in an average, m
  double tau_s = 0;         ///< m times the sampling period
  double variance = 0;      ///< in the square of the rate's unit
};

/// Overlapping Allan variance (IEEE Std 952-1997, Annex C; Riley 2008, eq. 11) of `rates`, sampled every
/// `period_s`:
///
///   sigma^2(m T) = 1 / (2 (m T)^2 (n + 1 - 2m)) sum_k (x_{k+2m} - 2 x_{k+m} + x_k)^2,   x_k = T sum_{i<k}
///   y_i
///
/// at clusters m that grow by sqrt(2), up to a quarter of the record. Preconditions: at least 8 rates,
/// period_s > 0.
[[nodiscard]] std::vector<AllanPoint> OverlappingAllanVariance(const std::vector<double>& rates,
                                                               double period_s);

/// Power of the four noises of a rate, each as the square of its usual coefficient (IEEE Std 952):
///
///   sigma^2(tau) = 3 Q^2 / tau^2 + N^2 / tau + (2 ln 2 / pi) B^2 + K^2 tau / 3
struct NoisePowers {
  static constexpr int kCount = 4;
  enum Index { kQuantisation, kWhite, kFlicker, kWalk };

  Eigen::Vector4d value = Eigen::Vector4d::Zero();  ///< Q^2, N^2, B^2, K^2

  /// The variance that each unit of power adds at `tau_s`.
  [[nodiscard]] static Eigen::Vector4d VariancePerUnit(double tau_s);
  [[nodiscard]] double VarianceAt(double tau_s) const { return VariancePerUnit(tau_s).dot(value); }
};

/// Covariance of Allan variances estimated from a record of Gaussian rates. By Isserlis' theorem
///
///   cov(sigma^2_a, sigma^2_b) = 1 / (2 tau_a^2 tau_b^2 M_a M_b) sum_s n(s) c(s)^2,   M = samples + 1 - 2m,
///
/// with c(s) the cross-covariance of the second differences of x over m_a and m_b, s samples apart, and n(s)
/// the number of such pairs. Second differences annul straight lines, so c follows from the generalised
/// covariances of x: Q^2 delta(s), -N^2 |s| / 2, B^2 s^2 ln|s| / (2 pi) and K^2 |s|^3 / 12. c is linear in
/// the powers and the covariance quadratic. The sum is exact where c has kinks close together, and a
/// quadrature elsewhere.
class AllanCovariance {
 public:
  AllanCovariance(const std::vector<AllanPoint>& points, std::size_t samples);

  /// points x points.
  [[nodiscard]] Eigen::MatrixXd At(const NoisePowers& powers) const;

 private:
  /// The part of each product of two powers, row by row of the lower triangle.
  std::array<Eigen::MatrixXd, NoisePowers::kCount*(NoisePowers::kCount + 1) / 2> parts_;
  Eigen::Vector4d scale_;  ///< to powers of rates in the unit of one sample
};

}  // namespace alidade
