#include "frontend/initialization/static_initializer.h"

#include <algorithm>
#include <cmath>

#include "core/check.h"
#include "core/dense_solvers.h"
#include "core/format.h"

namespace alidade {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// A resting gyroscope shows its bias (0.08 rad/s on EuRoC) and nothing else.
constexpr double kMaxRestingRateRadps = 0.2;
// A resting accelerometer shows gravity and its bias (1 m/s^2 on a phone).
constexpr double kMaxGravityErrorMps2 = 2.0;
// Slow rotations change the specific force without spreading it much.
constexpr double kDriftOfSpreadLimit = 0.5;
constexpr double kShownToHiddenBias = 1.5;
constexpr double kGravityStdMps2 = 0.02;
constexpr double kGyroBiasFloorRadps = 1e-4;  // the Earth's own rate
constexpr size_t kBlocks = 10;
constexpr int kMinCommonTracks = 8;
// At rest the tracker keeps its tracks.
constexpr double kMinCommonFraction = 0.2;

/// Variance of a mean over the interval: white noise of the sheet, or the slower motion that the blocks show.
double VarianceOfMean(double density, double mean_std, double duration_s) {
  return std::max(density * density / duration_s, mean_std * mean_std);
}

/// Scatter of block means as standard deviation of the whole mean, one axis.
double MeanDeviation(std::span<const ImuSample> samples, Vector3d ImuSample::*signal, const Vector3d& mean) {
  const size_t blocks = std::min<size_t>(kBlocks, samples.size());
  double sum = 0;
  for (size_t b = 0; b < blocks; ++b) {
    const size_t begin = b * samples.size() / blocks;
    const size_t end = (b + 1) * samples.size() / blocks;
    Vector3d block_mean = Vector3d::Zero();
    for (size_t i = begin; i < end; ++i) {
      block_mean += samples[i].*signal / static_cast<double>(end - begin);
    }
    sum += (block_mean - mean).squaredNorm() / 3;
  }
  return std::sqrt(sum / static_cast<double>(blocks * std::max<size_t>(blocks - 1, 1)));
}

std::string ReasonFromTracks(const InitConfig& config, const TrackMotion& motion) {
  if (motion.common < kMinCommonTracks || motion.common < kMinCommonFraction * motion.candidates) {
    return Format("moving: only %d of %d tracks persist over the window", motion.common, motion.candidates);
  }
  if (motion.motion_px > config.static_max_parallax_px) {
    return Format("moving: tracks move %.2f px, limit %.2f", motion.motion_px, config.static_max_parallax_px);
  }
  return {};
}

std::string ReasonFromImu(const InitConfig& config, double gravity_mps2, const ImuSpread& spread) {
  const double drift_limit = kDriftOfSpreadLimit * config.static_max_accel_std_mps2;
  if (spread.gyro_std_radps > config.static_max_gyro_std_radps) {
    return Format("moving: gyro spread %.3g rad/s exceeds %.3g", spread.gyro_std_radps,
                  config.static_max_gyro_std_radps);
  }
  if (spread.accel_std_mps2 > config.static_max_accel_std_mps2) {
    return Format("moving: accelerometer spread %.3g m/s^2 exceeds %.3g", spread.accel_std_mps2,
                  config.static_max_accel_std_mps2);
  }
  if (spread.accel_drift_mps2 > drift_limit) {
    return Format("moving: specific force drifts %.3g m/s^2, limit %.3g", spread.accel_drift_mps2,
                  drift_limit);
  }
  if (spread.mean_gyro.norm() > kMaxRestingRateRadps) {
    return Format("moving: mean rate %.3g rad/s is more than a gyro bias, limit %.3g",
                  spread.mean_gyro.norm(), kMaxRestingRateRadps);
  }
  if (std::abs(spread.mean_accel.norm() - gravity_mps2) > kMaxGravityErrorMps2) {
    return Format("moving: mean specific force %.3g m/s^2 is not gravity %.3g", spread.mean_accel.norm(),
                  gravity_mps2);
  }
  return {};
}

}  // namespace

ImuSpread MeasureImuSpread(std::span<const ImuSample> samples) {
  CHECK_GE(samples.size(), 2U);
  ImuSpread spread{MeasureImu(samples)};
  spread.samples = static_cast<int>(samples.size());
  spread.duration_s = SecondsBetween(samples.front().stamp_ns, samples.back().stamp_ns);
  const size_t half = samples.size() / 2;
  const Vector3d first_half = MeasureImu(samples.first(half)).mean_accel;
  const Vector3d second_half = MeasureImu(samples.subspan(half)).mean_accel;
  spread.accel_drift_mps2 = (second_half - first_half).norm();
  spread.gyro_mean_std_radps = MeanDeviation(samples, &ImuSample::gyro, spread.mean_gyro);
  spread.accel_mean_std_mps2 = MeanDeviation(samples, &ImuSample::accel, spread.mean_accel);
  return spread;
}

RestAssessment AssessRest(const InitConfig& config, double gravity_mps2, const ImuSpread& spread,
                          const std::optional<TrackMotion>& motion) {
  std::string reason = ReasonFromImu(config, gravity_mps2, spread);
  if (reason.empty() && motion.has_value()) {
    reason = ReasonFromTracks(config, *motion);
  }
  if (!reason.empty()) {
    return {StaticVerdict::kMoving, reason};
  }
  // The interval's ends are interpolated to the frame, so that only rounding may be missing.
  if (spread.duration_s < config.static_window_s - 1e-6) {
    return {StaticVerdict::kTooShort,
            Format("at rest for %.2f s of %.2f s", spread.duration_s, config.static_window_s)};
  }
  return {StaticVerdict::kAtRest, {}};
}

NavEstimate StateAtRest(const InitConfig& config, double gravity_mps2, const ImuNoise& noise,
                        const ImuSpread& spread, TimeNs stamp_ns) {
  NavEstimate estimate;
  estimate.stamp_ns = stamp_ns;
  const double magnitude = spread.mean_accel.norm();
  const Vector3d up = spread.mean_accel / magnitude;
  const double roll = std::atan2(up.y(), up.z());
  const double pitch = std::atan2(-up.x(), std::hypot(up.y(), up.z()));
  estimate.nav.R_WB = so3::Exp(pitch * Vector3d::UnitY()) * so3::Exp(roll * Vector3d::UnitX());
  estimate.bias.gyro = spread.mean_gyro;
  estimate.bias.accel = (magnitude - gravity_mps2) * up;

  // Information over (phi, b_a): the mean specific force, the prior of b_a across u (along u, too, but there
  // the measured (|f| - g) is its mean), and yaw.
  const double accel_variance =
      VarianceOfMean(noise.accel_noise_density_mps2_sqrthz, spread.accel_mean_std_mps2, spread.duration_s);
  const Matrix3d along = up * up.transpose();
  const Matrix3d weight = (Matrix3d::Identity() - along) / accel_variance +
                          along / (accel_variance + kGravityStdMps2 * kGravityStdMps2);
  Eigen::Matrix<double, 3, 6> jacobian;
  jacobian << gravity_mps2 * Skew(up), Matrix3d::Identity();
  Matrix6d information = jacobian.transpose() * weight * jacobian;
  information.topLeftCorner<3, 3>() += along / (config.yaw_std_rad * config.yaw_std_rad);
  // The one component of b_a that rest shows is a sample of the population of the two it hides.
  const double accel_bias_std =
      std::max(config.accel_bias_std_mps2, kShownToHiddenBias * std::abs(magnitude - gravity_mps2));
  information.bottomRightCorner<3, 3>() += Matrix3d::Identity() / (accel_bias_std * accel_bias_std);
  const Matrix6d covariance = SymmetricSolver(information).Solve(Matrix6d::Identity());
  const double walk = noise.gyro_random_walk_radps2_sqrthz;
  const double gyro_variance =
      VarianceOfMean(noise.gyro_noise_density_radps_sqrthz, spread.gyro_mean_std_radps, spread.duration_s) +
      walk * walk * spread.duration_s / 3 + kGyroBiasFloorRadps * kGyroBiasFloorRadps;

  Matrix15d& p = estimate.covariance;
  p.setZero();
  p.block<3, 3>(0, 0) = covariance.topLeftCorner<3, 3>();
  p.block<3, 3>(0, 12) = covariance.topRightCorner<3, 3>();
  p.block<3, 3>(12, 0) = covariance.bottomLeftCorner<3, 3>();
  p.block<3, 3>(12, 12) = covariance.bottomRightCorner<3, 3>();
  p.diagonal().segment<3>(3).setConstant(config.position_std_m * config.position_std_m);
  p.diagonal().segment<3>(6).setConstant(config.velocity_std_mps * config.velocity_std_mps);
  p.diagonal().segment<3>(9).setConstant(gyro_variance);
  p = (0.5 * (p + p.transpose())).eval();
  return estimate;
}

}  // namespace alidade
