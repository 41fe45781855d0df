#pragma once

#include <Eigen/Core>
#include <deque>
#include <optional>

#include "core/imu_sample.h"

namespace alidade {

/// Rotation of the body between two times from gyroscope samples.
class GyroRotation {
 public:
  /// False, and ignored: a stamp that does not increase, or an angular rate that is not finite.
  bool Add(const ImuSample& sample);

  /// R_B0B1: p_B0 = R_B0B1 p_B1 between IMU times t0 < t1, rate less `bias` [rad/s] linear between samples
  /// and held beyond the first and the last one. Empty where samples that [t0, t1] reaches are more than
  /// kMaxGapS apart, or it reaches so far beyond them.
  [[nodiscard]] std::optional<Eigen::Matrix3d> Between(
      TimeNs t0_ns, TimeNs t1_ns, const Eigen::Vector3d& bias = Eigen::Vector3d::Zero()) const;
  /// Forgets what rotations from t0 on do not need.
  void DropBefore(TimeNs t0_ns);

  /// Longest stretch without a sample over which the rate is interpolated or held.
  static constexpr double kMaxGapS = 0.05;

 private:
  [[nodiscard]] bool Covers(TimeNs t0_ns, TimeNs t1_ns) const;
  /// Angular rate [rad/s] at t, clamped to the samples' span. Needs one sample at least.
  [[nodiscard]] Eigen::Vector3d RateAt(TimeNs t_ns) const;

  std::deque<ImuSample> samples_;
};

}  // namespace alidade
