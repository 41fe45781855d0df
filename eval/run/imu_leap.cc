#include "eval/run/imu_leap.h"

#include <utility>

namespace alidade {
namespace {

bool Leaps(TimeNs from_ns, TimeNs to_ns) {
  return from_ns != INT64_MIN && SecondsBetween(from_ns, to_ns) > ImuLeap::kMaxLeapS;
}

}  // namespace

ImuLeap::Judgement ImuLeap::Judge(const ImuSample& sample, TimeNs newest_ns) {
  Judgement judgement;
  if (held_ && sample.stamp_ns == held_->stamp_ns) {
    judgement.verdict = Verdict::kTwice;
    return judgement;
  }
  if (held_) {
    const ImuSample held = *std::exchange(held_, std::nullopt);
    if (sample.stamp_ns > held.stamp_ns && !Leaps(held.stamp_ns, sample.stamp_ns)) {
      judgement.confirmed = held;
      return judgement;
    }
    judgement.refused = held;
  }
  if (Leaps(newest_ns, sample.stamp_ns)) {
    judgement.verdict = Verdict::kHold;
    held_ = sample;
  }
  return judgement;
}

std::optional<ImuSample> ImuLeap::Release(TimeNs stamp_ns) {
  return held_ && held_->stamp_ns <= stamp_ns ? std::exchange(held_, std::nullopt) : std::nullopt;
}

}  // namespace alidade
