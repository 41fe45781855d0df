#pragma once

#include <optional>

#include "core/imu_sample.h"

namespace alidade {

/// Holds back an inertial sample whose stamp leaps ahead of those before it, until the next one shows whether
/// time did: taken in, a single wrong stamp would make all that follows late.
///
/// A sample leaps when it lies more than kMaxLeapS after the newest one taken. One that comes after the held
/// sample, and by no more than that, confirms it; any other refuses it, and may leap itself. A sample held
/// waits as long as no other comes.
class ImuLeap {
 public:
  static constexpr double kMaxLeapS = 1;

  /// What becomes of the sample at hand.
  enum class Verdict {
    kTake,
    kHold,
    kTwice,  ///< it has the stamp of the one held, which stays
  };
  struct Outcome {
    Verdict verdict = Verdict::kTake;
    // Of the sample held before, at most one of:
    std::optional<ImuSample> confirmed;  ///< to be taken in first
    std::optional<ImuSample> refused;
  };

  /// `newest_ns`: stamp of the newest sample that was taken; INT64_MIN before the first, which cannot leap.
  Outcome Add(const ImuSample& sample, TimeNs newest_ns);
  /// Lets the held sample go when it lies at or before `stamp_ns`, as none before that is awaited any more.
  std::optional<ImuSample> Release(TimeNs stamp_ns);
  [[nodiscard]] bool holds() const { return held_.has_value(); }

 private:
  std::optional<ImuSample> held_;
};

}  // namespace alidade
