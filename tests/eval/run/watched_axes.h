#pragma once

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "core/random.h"
#include "eval/run/imu_axis_watch.h"

// A motion, and what ImuAxisWatch finds in it.

namespace alidade::test {

inline constexpr double kRateHz = 200;

/// Motion of some hertz with noise, measured with a resolution of `step`.
inline std::vector<ImuSample> Motion(int count, double step, double amplitude = 1) {
  RandomStream random(7, "imu");
  const auto rounded = [&](const Eigen::Vector3d& value) {
    return Eigen::Vector3d(step * (value / step).array().round());
  };
  std::vector<ImuSample> samples;
  for (int k = 0; k < count; ++k) {
    const double t = k / kRateHz;
    const Eigen::Vector3d gyro(std::sin(5 * t), std::cos(4 * t), std::sin(3 * t + 1));
    const Eigen::Vector3d accel(3 * std::sin(4 * t), 2 * std::cos(5 * t), 3 * std::sin(6 * t));
    samples.push_back({SecondsToNs(t), rounded(amplitude * gyro + 1e-3 * random.Normal3()),
                       rounded(Eigen::Vector3d(0, 0, 9.81) + amplitude * accel + 1e-2 * random.Normal3())});
  }
  return samples;
}

struct Watched {
  std::vector<std::string> reported;
  std::vector<bool> faulty;
  std::vector<ImuSample> samples;
};

inline Watched Watch(std::vector<ImuSample> samples, const ImpliedImu* implied = nullptr) {
  ImuAxisWatch watch(implied);
  Watched watched;
  for (ImuSample& sample : samples) {
    if (const std::string reported = watch.Add(&sample); !reported.empty()) {
      watched.reported.push_back(reported);
    }
    watched.faulty.push_back(!watch.reason().empty());
  }
  watched.samples = std::move(samples);
  return watched;
}

}  // namespace alidade::test
