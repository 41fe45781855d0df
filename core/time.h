#pragma once

#include <cstdint>
#include <string>

namespace alidade {

/// Time since the epoch of the data set, integer nanoseconds. A double of seconds loses 0.2 us at Unix time.
using TimeNs = std::int64_t;

inline constexpr double kNsToSeconds = 1e-9;
inline constexpr TimeNs kSecondNs = 1'000'000'000;

/// Largest magnitude of a stamp that readers take, 1824 to 2115 of Unix time: the difference of two fits
/// TimeNs.
inline constexpr TimeNs kMaxStampNs = 4'600'000'000'000'000'000;
/// Largest difference of two clocks that readers take: a stamp and it fit TimeNs. Epochs from 1900 on are
/// closer to each other.
inline constexpr double kMaxClockOffsetS = 4.6e9;

/// later - earlier [s]; exact to double precision because the subtraction is done on integers.
[[nodiscard]] constexpr double SecondsBetween(TimeNs earlier, TimeNs later) {
  return static_cast<double>(later - earlier) * kNsToSeconds;
}

/// Nearest integer nanoseconds of a duration in seconds.
[[nodiscard]] constexpr TimeNs SecondsToNs(double seconds) {
  return static_cast<TimeNs>(seconds * 1e9 + (seconds < 0 ? -0.5 : 0.5));
}

/// Whether a stamp of one clock, within the limits above, is one of another clock within them too.
[[nodiscard]] constexpr bool IsStampWithOffset(TimeNs stamp_ns, double offset_s) {
  const TimeNs shifted_ns = stamp_ns + SecondsToNs(offset_s);
  return -kMaxStampNs <= shifted_ns && shifted_ns <= kMaxStampNs;
}

/// "1403715273.262142976": printed from the integer, nine decimals, no rounding.
[[nodiscard]] std::string FormatSeconds(TimeNs stamp_ns);

}  // namespace alidade
