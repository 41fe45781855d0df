#pragma once

#include <cmath>
#include <optional>

namespace alidade {

/// Which images the tracker of VINS-Mono and its descendants hands to the solver: as many that their mean
/// rate since the last reset, rounded to 1 Hz, does not exceed the limit; a reset when it is within 1 % of
/// it. The first image only starts the clock.
class PublishRate {
 public:
  explicit PublishRate(double limit_hz) : limit_hz_(limit_hz) {}

  /// Whether the tracker hands over the image of this time [s]; empty: it does not see the image at all.
  std::optional<bool> Take(double time_s) {
    if (!started_) {
      started_ = true;
      start_s_ = time_s;
      return std::nullopt;
    }
    const double rate_hz = handed_over_ / (time_s - start_s_);
    if (std::round(rate_hz) > limit_hz_) {
      return false;
    }
    if (std::abs(rate_hz - limit_hz_) < 0.01 * limit_hz_) {
      start_s_ = time_s;
      handed_over_ = 0;
    }
    ++handed_over_;
    return true;
  }

 private:
  double limit_hz_;
  bool started_ = false;
  double start_s_ = 0;
  int handed_over_ = 1;
};

}  // namespace alidade
