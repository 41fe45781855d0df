#include "core/imu_vibration.h"

#include <algorithm>
#include <cmath>

namespace alidade {
namespace {

constexpr double kUnevenSteps = 0.1;  // relative
// Variance of e_k / dt of white samples of unit variance: 4 / 24^2.
constexpr double kWhiteShare = 4.0 / (24 * 24);
constexpr double kCubicDivisor = 24;

/// Density that has the larger of nothing and what the mean square of e_k / sqrt(dt) has beyond white noise.
double WithExcess(double density, double mean_square) {
  return std::sqrt(density * density + std::max(0.0, mean_square - kWhiteShare * density * density));
}

}  // namespace

ImuNoise AddVibration(std::span<const ImuSample> samples, const ImuNoise& noise) {
  double gyro = 0;
  double accel = 0;
  double count = 0;
  for (size_t k = 1; k + 2 < samples.size(); ++k) {
    const double before_s = SecondsBetween(samples[k - 1].stamp_ns, samples[k].stamp_ns);
    const double step_s = SecondsBetween(samples[k].stamp_ns, samples[k + 1].stamp_ns);
    const double after_s = SecondsBetween(samples[k + 1].stamp_ns, samples[k + 2].stamp_ns);
    if (std::max(std::abs(before_s - step_s), std::abs(after_s - step_s)) > kUnevenSteps * step_s) {
      continue;
    }
    const auto unresolved = [&](const auto& of) {
      return (of(samples[k - 1]) - of(samples[k]) - of(samples[k + 1]) + of(samples[k + 2])).squaredNorm();
    };
    gyro +=
        step_s * unresolved([](const ImuSample& sample) -> const Eigen::Vector3d& { return sample.gyro; });
    accel +=
        step_s * unresolved([](const ImuSample& sample) -> const Eigen::Vector3d& { return sample.accel; });
    count += 3 * kCubicDivisor * kCubicDivisor;
  }
  ImuNoise with = noise;
  if (count > 0) {
    with.gyro_noise_density_radps_sqrthz = WithExcess(noise.gyro_noise_density_radps_sqrthz, gyro / count);
    with.accel_noise_density_mps2_sqrthz = WithExcess(noise.accel_noise_density_mps2_sqrthz, accel / count);
  }
  return with;
}

}  // namespace alidade
