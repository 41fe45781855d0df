#pragma once

#include <cstdint>
#include <string>

namespace alidade {

/// Time since the epoch of the data set, integer nanoseconds. A double of seconds loses 0.2 us at Unix time.
using TimeNs = std::int64_t;

inline constexpr double kNsToSeconds = 1e-9;
inline constexpr TimeNs kSecondNs = 1'000'000'000;

/// later - earlier [s]; exact to double precision because the subtraction is done on integers.
[[nodiscard]] constexpr double SecondsBetween(TimeNs earlier, TimeNs later) {
  return static_cast<double>(later - earlier) * kNsToSeconds;
}

/// Nearest integer nanoseconds of a duration in seconds.
[[nodiscard]] constexpr TimeNs SecondsToNs(double seconds) {
  return static_cast<TimeNs>(seconds * 1e9 + (seconds < 0 ? -0.5 : 0.5));
}

/// "1403715273.262142976": printed from the integer, nine decimals, no rounding.
[[nodiscard]] std::string FormatSeconds(TimeNs stamp_ns);

}  // namespace alidade
