#pragma once

#include <Eigen/Core>
#include <deque>
#include <optional>

#include "core/imu_sample.h"

namespace alidade {

/// Rotation vector [rad] of a body over a step of dt_s by the trapezoid: the mean of the rates [rad/s] at
/// both ends, less `bias_radps`, in the body's axes.
///
/// For turns over two seconds at most that are compared with images or poses. Against MeanOverStep
/// (core/imu_step.h), which estimators integrate, the curvature of the rate, dt^3/12 w'', and the coning,
/// dt^2/12 w_k x w_{k+1}, are left out. At 0.8 rad/s an axis, 1 Hz and 200 samples a second that is 5e-7 and
/// 6e-8 rad a step, and 3e-5 rad at most within 1 s: 0.01 px at 460 pixels a radian.
[[nodiscard]] Eigen::Vector3d TurnOverStep(const Eigen::Vector3d& from_radps, const Eigen::Vector3d& to_radps,
                                           double dt_s,
                                           const Eigen::Vector3d& bias_radps = Eigen::Vector3d::Zero());

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
  /// Moves the samples from `from_ns` on back by `by_ns`, less than the step before them.
  void TakeBack(TimeNs from_ns, TimeNs by_ns);
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
