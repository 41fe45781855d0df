#include "core/gyro_rotation.h"

#include <algorithm>

#include "core/imu_buffer.h"
#include "core/lie.h"

namespace alidade {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Vector3d TurnOverStep(const Vector3d& from_radps, const Vector3d& to_radps, double dt_s,
                      const Vector3d& bias_radps) {
  return (0.5 * (from_radps + to_radps) - bias_radps) * dt_s;
}

bool GyroRotation::Add(const ImuSample& sample) {
  if (!sample.gyro.allFinite() || (!samples_.empty() && sample.stamp_ns <= samples_.back().stamp_ns)) {
    return false;
  }
  samples_.push_back(sample);
  return true;
}

bool GyroRotation::Covers(TimeNs t0_ns, TimeNs t1_ns) const {
  // The samples around t0 and t1 are part of it: the rate is interpolated between them.
  TimeNs before_ns = INT64_MIN;
  for (const ImuSample& sample : samples_) {
    if (sample.stamp_ns > t0_ns &&
        SecondsBetween(before_ns == INT64_MIN ? t0_ns : before_ns, sample.stamp_ns) > kMaxGapS) {
      return false;
    }
    before_ns = sample.stamp_ns;
    if (before_ns >= t1_ns) {
      return true;
    }
  }
  return before_ns != INT64_MIN && SecondsBetween(before_ns, t1_ns) <= kMaxGapS;
}

Vector3d GyroRotation::RateAt(TimeNs t_ns) const {
  const auto after = std::lower_bound(samples_.begin(), samples_.end(), t_ns,
                                      [](const ImuSample& sample, TimeNs t) { return sample.stamp_ns < t; });
  if (after == samples_.begin()) {
    return samples_.front().gyro;
  }
  if (after == samples_.end()) {
    return samples_.back().gyro;
  }
  return Interpolate(*(after - 1), *after, t_ns).gyro;
}

void GyroRotation::TakeBack(TimeNs from_ns, TimeNs by_ns) {
  for (ImuSample& sample : samples_) {
    sample.stamp_ns -= sample.stamp_ns >= from_ns ? by_ns : 0;
  }
}

void GyroRotation::DropBefore(TimeNs t0_ns) {
  // The last sample at or before t0 is kept: the rate at t0 is interpolated from it.
  while (samples_.size() >= 2 && samples_[1].stamp_ns <= t0_ns) {
    samples_.pop_front();
  }
}

std::optional<Matrix3d> GyroRotation::Between(TimeNs t0_ns, TimeNs t1_ns, const Vector3d& bias) const {
  if (t1_ns <= t0_ns || !Covers(t0_ns, t1_ns)) {
    return std::nullopt;
  }
  Matrix3d R_B0B = Matrix3d::Identity();
  TimeNs from_ns = t0_ns;
  const auto advance = [&](TimeNs to_ns) {
    R_B0B =
        R_B0B * so3::Exp(TurnOverStep(RateAt(from_ns), RateAt(to_ns), SecondsBetween(from_ns, to_ns), bias));
    from_ns = to_ns;
  };
  for (const ImuSample& sample : samples_) {
    if (sample.stamp_ns > t0_ns && sample.stamp_ns < t1_ns) {
      advance(sample.stamp_ns);
    }
  }
  advance(t1_ns);
  return R_B0B;
}

}  // namespace alidade
