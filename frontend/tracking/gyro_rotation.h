#pragma once

#include <Eigen/Core>
#include <deque>
#include <optional>

#include "core/imu_sample.h"

namespace alidade {

/// Rotation between two image stamps from gyroscope samples, biases neglected (0.1 rad/s over 50 ms is 5
/// mrad: a good start for a search, not a measurement).
class GyroRotation {
 public:
  /// False, and ignored: a stamp that does not increase, or an angular rate that is not finite.
  bool Add(const ImuSample& sample);

  /// R_B0B1: p_B0 = R_B0B1 p_B1 between IMU times t0 < t1, rate linear between samples and held beyond the
  /// last one. Samples before t0 are forgotten. Empty when samples leave more than kMaxGapS of [t0, t1]
  /// uncovered in one piece.
  std::optional<Eigen::Matrix3d> Between(TimeNs t0_ns, TimeNs t1_ns);

  /// Longest stretch without a sample over which the rate is interpolated or held.
  static constexpr double kMaxGapS = 0.05;

 private:
  [[nodiscard]] bool Covers(TimeNs t0_ns, TimeNs t1_ns) const;
  /// Angular rate [rad/s] at t, clamped to the samples' span. Needs one sample at least.
  [[nodiscard]] Eigen::Vector3d RateAt(TimeNs t_ns) const;

  std::deque<ImuSample> samples_;
};

}  // namespace alidade
