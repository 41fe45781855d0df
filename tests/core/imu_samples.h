#pragma once

#include <vector>

#include "core/imu_sample.h"
#include "tests/support/random_states.h"

namespace alidade::test {

constexpr double kGravity = 9.81;

/// A turn of up to `max_rate` rad/s an axis under gravity, with 0.3 rad/s and 3 m/s^2 of change from sample
/// to sample.
inline std::vector<ImuSample> RandomSamples(RandomStates* random, int count, double rate_hz,
                                            double max_rate = 1.5) {
  std::vector<ImuSample> samples;
  samples.reserve(static_cast<size_t>(count));
  const Eigen::Vector3d omega = random->Vector(max_rate);
  for (int i = 0; i < count; ++i) {
    samples.push_back({SecondsToNs(i / rate_hz), omega + random->Vector(0.3),
                       Eigen::Vector3d(0, 0, kGravity) + random->Vector(3)});
  }
  return samples;
}

}  // namespace alidade::test
