#include "eval/run/imu_clock.h"

namespace alidade {

using Eigen::Matrix3d;

void ImuClock::Settle() {
  if (silence_) {
    settled_ns_ = silence_->end_ns;
  }
  silence_.reset();
  first_.reset();
}

bool ImuClock::FindJump(const TrackFrame& frame, TimeNs imu_ns, const GyroRotation& gyro,
                        const Eigen::Vector3d& gyro_bias) {
  compared_ns_ = frame.stamp_ns;
  if (imu_ns < silence_->end_ns) {
    return false;
  }
  ClockVerdict verdict = ClockVerdict::kUnknown;
  if (first_) {
    const auto misfit = [&](TimeNs shift_ns) {
      const std::optional<Matrix3d> turn =
          gyro.Between(first_->imu_ns + shift_ns, imu_ns + shift_ns, gyro_bias);
      return turn ? TurnMisfit(rig_, pixel_noise_px_, first_->frame, frame, *turn) : std::nullopt;
    };
    verdict = votes_.Add(misfit(0), misfit(silence_->excess_ns));
  }
  if (verdict == ClockVerdict::kUnknown) {
    first_ = Seen{frame, imu_ns};
  }
  if (verdict == ClockVerdict::kHolds || SecondsBetween(silence_->end_ns, imu_ns) > kDoubtS) {
    Settle();
  }
  return verdict == ClockVerdict::kJumped;
}

}  // namespace alidade
