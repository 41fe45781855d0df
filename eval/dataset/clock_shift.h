#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/time.h"

namespace alidade {

/// A difference between clocks that recorders use.
struct ClockShift {
  TimeNs shift_ns = 0;  ///< to be added to the stamps of a sensor
  std::string name;
};

/// The differences that are met, smallest first, each of either sign: between UTC, GPST and TAI at about
/// `near_ns` (none of UTC before 1981: such stamps count from elsewhere), whole hours up to 14 (time zones
/// reach from -12 to +14 h) and a day.
[[nodiscard]] std::vector<ClockShift> KnownClockShifts(TimeNs near_ns);

struct TimeSpan {
  TimeNs first_ns = 0;
  TimeNs last_ns = 0;
};

/// Of spans without common time: the known shift of `sensor` that makes most of the shorter span common, and
/// at least half of it; of several that differ by less than 1 %, the smallest.
struct Meeting {
  ClockShift shift;
  double share = 0;  ///< of the shorter span that is then common
};
[[nodiscard]] std::optional<Meeting> ShiftOntoSpan(const TimeSpan& sensor, const TimeSpan& imu);

/// Of spans with common time: the known shift that brings both ends of `sensor` to within two seconds of
/// those of `imu`. Recorders start and stop together, but for one that is off by so much at both ends.
[[nodiscard]] std::optional<ClockShift> ShiftOfBothEnds(const TimeSpan& sensor, const TimeSpan& imu);

}  // namespace alidade
