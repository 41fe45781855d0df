#include <algorithm>

#include "eval/run/session.h"

// Silences of the IMU that may be jumps of its clock.

namespace alidade {

bool Session::IsInDoubt(const Due& due) {
  const TimeNs needed_ns = due.imu_ns + LeadOf(due);
  if (!options_.camera) {
    return false;
  }
  if (!imu_clock_.silence()) {
    const std::optional<ImuSilence> silence = loop_.imu().FirstSilence(imu_clock_.settled_ns(), needed_ns);
    if (!silence) {
      return false;
    }
    imu_clock_.Question(*silence);
  }
  if (needed_ns <= imu_clock_.silence()->begin_ns) {
    return false;
  }
  DecideOnSilence();
  return imu_clock_.silence().has_value();
}

void Session::DecideOnSilence() {
  const ImuSilence silence = *imu_clock_.silence();
  for (auto frame = frames_.upper_bound(imu_clock_.compared_ns());
       frame != frames_.end() && imu_clock_.silence(); ++frame) {
    const TimeNs imu_ns = frame->first + frame_offset_ns_;
    if (imu_ns > Watermark() || !ImuReaches(imu_ns + silence.excess_ns)) {
      break;
    }
    GyroRotation gyro;
    for (const ImuSample& sample : loop_.imu().Since(silence.end_ns)) {
      gyro.Add(sample);
    }
    if (imu_clock_.FindJump(frame->second, imu_ns, gyro, GyroBias())) {
      TakeBackImuJump();
    }
  }
  const TimeNs end_ns = silence.end_ns + silence.excess_ns + SecondsToNs(ImuClock::kDoubtS);
  if (Watermark() > end_ns) {
    imu_clock_.Settle();
  }
}

void Session::TakeBackImuJump() {
  const ImuSilence silence = *imu_clock_.silence();
  imu_jump_ns_ += silence.excess_ns;
  loop_.imu().TakeBack(silence);
  advanced_ns_ = std::min(advanced_ns_, loop_.imu().newest_ns());
  camera_clock_.TakeBackImu(silence.end_ns, silence.excess_ns);
  loop_.OnClockJump("IMU", SecondsBetween(0, silence.excess_ns));
  imu_clock_.Settle();
}

void Session::EndDoubt() {
  while (imu_clock_.silence()) {
    imu_clock_.Settle();
    Process();
  }
}

}  // namespace alidade
