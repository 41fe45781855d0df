#include "eval/run/imu_leap.h"

#include <utility>

namespace alidade {
namespace {

bool Leaps(TimeNs from_ns, TimeNs to_ns) {
  return from_ns != INT64_MIN && SecondsBetween(from_ns, to_ns) > ImuLeap::kMaxLeapS;
}

}  // namespace

ImuLeap::Outcome ImuLeap::Add(const ImuSample& sample, TimeNs newest_ns) {
  Outcome outcome;
  if (held_ && sample.stamp_ns == held_->stamp_ns) {
    outcome.verdict = Verdict::kTwice;
    return outcome;
  }
  if (held_) {
    const ImuSample held = *std::exchange(held_, std::nullopt);
    if (sample.stamp_ns > held.stamp_ns && !Leaps(held.stamp_ns, sample.stamp_ns)) {
      outcome.confirmed = held;
      return outcome;
    }
    outcome.refused = held;
  }
  if (Leaps(newest_ns, sample.stamp_ns)) {
    outcome.verdict = Verdict::kHold;
    held_ = sample;
  }
  return outcome;
}

std::optional<ImuSample> ImuLeap::Release(TimeNs stamp_ns) {
  return held_ && held_->stamp_ns <= stamp_ns ? std::exchange(held_, std::nullopt) : std::nullopt;
}

}  // namespace alidade
