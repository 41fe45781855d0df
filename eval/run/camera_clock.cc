#include "eval/run/camera_clock.h"

#include "core/median.h"
#include "eval/run/turn_misfit.h"

namespace alidade {

using Eigen::Matrix3d;
using Eigen::Vector3d;

void CameraClock::AddImu(const ImuSample& sample) {
  if (gyro_.Add(sample)) {
    gyro_.DropBefore(sample.stamp_ns - SecondsToNs(1.5 * kMostStepS));
  }
}

std::optional<TimeNs> CameraClock::Period() const {
  constexpr std::size_t kLeast = 5;
  if (steps_.size() < kLeast) {
    return std::nullopt;
  }
  return static_cast<TimeNs>(Median({steps_.begin(), steps_.end()}));
}

std::optional<TimeNs> CameraClock::FindJump(const TrackFrame& frame, TimeNs imu_ns,
                                            const Vector3d& gyro_bias) {
  constexpr std::size_t kRemembered = 15;
  std::optional<TimeNs> jump;
  const std::optional<TimeNs> period = Period();
  const TimeNs step_ns = last_ ? imu_ns - last_->imu_ns : 0;
  const bool opens = !step_ && period && SecondsBetween(0, step_ns) > kLeastStepS &&
                     SecondsBetween(0, step_ns) < kMostStepS &&
                     SecondsBetween(0, step_ns) > kLeastPeriods * SecondsBetween(0, *period);
  if (opens) {
    step_ = Step{*last_, step_ns - *period, imu_ns + SecondsToNs(kDoubtS)};
  } else if (step_ns > 0) {
    steps_.push_back(step_ns);
  }
  while (steps_.size() > kRemembered) {
    steps_.pop_front();
  }
  if (step_) {
    const TimeNs before_ns = step_->before.imu_ns;
    const auto misfit = [&](TimeNs until_ns) {
      const std::optional<Matrix3d> turn = gyro_.Between(before_ns, until_ns, gyro_bias);
      return turn ? TurnMisfit(rig_, pixel_noise_px_, step_->before.frame, frame, *turn) : std::nullopt;
    };
    const ClockVerdict verdict = CompareTurns(misfit(imu_ns), misfit(imu_ns - step_->excess_ns));
    if (verdict == ClockVerdict::kJumped) {
      jump = step_->excess_ns;
      imu_ns -= *jump;
    }
    if (verdict != ClockVerdict::kOpen || imu_ns > step_->end_ns) {
      step_.reset();
    }
  }
  last_ = Seen{frame, imu_ns};
  return jump;
}

}  // namespace alidade
