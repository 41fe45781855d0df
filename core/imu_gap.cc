#include "core/imu_gap.h"

#include <algorithm>
#include <cmath>

namespace alidade::imu_gap {
namespace {

double Length(const ImuSample& from, const ImuSample& to) {
  return std::max({SecondsBetween(from.stamp_ns, to.stamp_ns), from.gap_s, to.gap_s});
}

}  // namespace

bool IsInside(const ImuSample& from, const ImuSample& to) {
  return Length(from, to) > kMinGapS;
}

ImuNoise AddNoise(const ImuSample& from, const ImuSample& to, const ImuNoise& noise) {
  const double gap_s = Length(from, to);
  const double of_change = 0.5 * gap_s / SecondsBetween(from.stamp_ns, to.stamp_ns);
  const auto density = [&](double of_sensor, double floor, double change) {
    return std::hypot(of_sensor, std::max(floor, of_change * change) * std::sqrt(gap_s));
  };
  ImuNoise with = noise;
  with.gyro_noise_density_radps_sqrthz =
      density(noise.gyro_noise_density_radps_sqrthz, kMinGyroRadps, (to.gyro - from.gyro).norm());
  with.accel_noise_density_mps2_sqrthz =
      density(noise.accel_noise_density_mps2_sqrthz, kMinAccelMps2, (to.accel - from.accel).norm());
  return with;
}

}  // namespace alidade::imu_gap
