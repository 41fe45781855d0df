#include "eval/metrics/nees.h"

#include <Eigen/Cholesky>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/numbers.h"

namespace alidade {
namespace {

/// Smallest pivot of a correlation matrix taken as regular; below it the inverse is rounding noise.
constexpr double kMinimumPivot = 1e-12;

/// error^T covariance^-1 error, NaN when the covariance is not positive definite. Solved for the correlation
/// matrix, so that radians and metres of very different size do not look singular.
template <int N>
double NormalizedSquare(const Eigen::Matrix<double, N, 1>& error,
                        const Eigen::Matrix<double, N, N>& covariance) {
  if (!covariance.allFinite() || !error.allFinite() || covariance.diagonal().minCoeff() <= 0) {
    return kNan;
  }
  const Eigen::Matrix<double, N, 1> sigma = covariance.diagonal().cwiseSqrt();
  const Eigen::Matrix<double, N, N> correlation =
      sigma.cwiseInverse().asDiagonal() * covariance * sigma.cwiseInverse().asDiagonal();
  const Eigen::LDLT<Eigen::Matrix<double, N, N>> factor(correlation);
  if (factor.info() != Eigen::Success || factor.vectorD().minCoeff() < kMinimumPivot) {
    return kNan;
  }
  const Eigen::Matrix<double, N, 1> whitened = error.cwiseQuotient(sigma);
  return whitened.dot(factor.solve(whitened));
}

double NormalizedSquare3(const Eigen::Vector3d& truth, const Eigen::Vector3d& estimate,
                         const Eigen::Matrix3d& covariance) {
  return NormalizedSquare<3>(truth - estimate, covariance);
}

/// Mean of the values that are not NaN; NaN when there is none.
double MeanOfFinite(const std::vector<double>& values) {
  double sum = 0;
  std::size_t count = 0;
  for (const double value : values) {
    if (std::isfinite(value)) {
      sum += value;
      ++count;
    }
  }
  return count == 0 ? kNan : sum / static_cast<double>(count);
}

}  // namespace

Matrix6d ErrorCovariance(const StatePair& pair) {
  const Eigen::Vector3d phi = so3::Log(pair.estimate.nav.R_WB.transpose() * pair.truth.nav.R_WB);
  Matrix6d of_truth = Matrix6d::Identity();
  of_truth.topLeftCorner<3, 3>() = so3::RightJacobianInverse(phi);
  return pair.estimate.covariance + of_truth * pair.truth.covariance * of_truth.transpose();
}

NeesResult ComputeNees(const std::vector<StatePair>& pairs) {
  NeesResult result;
  std::vector<double> velocity, gyro_bias, accel_bias;
  std::size_t inside = 0, components = 0;
  for (const StatePair& pair : pairs) {
    const NavState& estimate = pair.estimate.nav;
    const Matrix6d covariance = ErrorCovariance(pair);
    Vector6d error;
    error << so3::Log(estimate.R_WB.transpose() * pair.truth.nav.R_WB), pair.truth.nav.p_WB - estimate.p_WB;

    result.pose.push_back(NormalizedSquare<6>(error, covariance));
    result.orientation.push_back(NormalizedSquare<3>(error.head<3>(), covariance.topLeftCorner<3, 3>()));
    result.position.push_back(NormalizedSquare<3>(error.tail<3>(), covariance.bottomRightCorner<3, 3>()));
    const MotionCovariance& motion = pair.estimate.motion_covariance;
    velocity.push_back(NormalizedSquare3(pair.truth.nav.v_WB, estimate.v_WB, motion.velocity));
    gyro_bias.push_back(NormalizedSquare3(pair.truth.bias.gyro, pair.estimate.bias.gyro, motion.gyro_bias));
    accel_bias.push_back(
        NormalizedSquare3(pair.truth.bias.accel, pair.estimate.bias.accel, motion.accel_bias));
    if (std::isfinite(result.pose.back())) {
      const Vector6d sigma = covariance.diagonal().cwiseSqrt();
      inside += static_cast<std::size_t>((error.array().abs() <= 3 * sigma.array()).count());
      components += 6;
    }
  }
  result.mean_pose = MeanOfFinite(result.pose);
  result.mean_orientation = MeanOfFinite(result.orientation);
  result.mean_position = MeanOfFinite(result.position);
  result.mean_velocity = MeanOfFinite(velocity);
  result.mean_gyro_bias = MeanOfFinite(gyro_bias);
  result.mean_accel_bias = MeanOfFinite(accel_bias);
  result.coverage_3sigma =
      components == 0 ? kNan : static_cast<double>(inside) / static_cast<double>(components);
  return result;
}

std::pair<double, double> NeesBand(int dof, double samples, double probability) {
  const double total_dof = dof * samples;
  if (!(total_dof > 0) || !std::isfinite(total_dof) || !(probability > 0 && probability < 1)) {
    return {kNan, kNan};
  }
  // The sum of the samples is chi-square with samples * dof degrees of freedom; the mean divides it.
  const boost::math::chi_squared sum(total_dof);
  const double tail = (1 - probability) / 2;
  return {boost::math::quantile(sum, tail) / samples,
          boost::math::quantile(boost::math::complement(sum, tail)) / samples};
}

double NeesOfSigmas(double sigmas, int dof) {
  const boost::math::chi_squared squares(dof);
  return boost::math::quantile(boost::math::complement(squares, std::erfc(sigmas / std::numbers::sqrt2)));
}

}  // namespace alidade
