#include "eval/dataset/clock_shift.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "core/format.h"
#include "gnss/base/gnss_time.h"

namespace alidade {
namespace {

/// Of the shorter span, the share that is common once the sensor's stamps are shifted; negative: none is.
double CommonShare(const TimeSpan& sensor, const TimeSpan& imu, TimeNs shift_ns) {
  const double shorter = std::max(kNsToSeconds, std::min(SecondsBetween(sensor.first_ns, sensor.last_ns),
                                                         SecondsBetween(imu.first_ns, imu.last_ns)));
  // As differences: a sum of arbitrary stamps might overflow.
  const double shift = SecondsBetween(0, shift_ns);
  const double starts = SecondsBetween(imu.first_ns, sensor.first_ns) + shift;
  const double ends = SecondsBetween(imu.first_ns, sensor.last_ns) + shift;
  const double imu_ends = SecondsBetween(imu.first_ns, imu.last_ns);
  return (std::min(ends, imu_ends) - std::max(starts, 0.0)) / shorter;
}

}  // namespace

std::vector<ClockShift> KnownClockShifts(TimeNs near_ns) {
  constexpr int kTaiLessGpstS = 19;
  constexpr int kLargestZoneH = 14;
  std::vector<ClockShift> shifts;
  const auto add = [&shifts](TimeNs shift_ns, const std::string& name) {
    shifts.push_back({shift_ns, name});
    shifts.push_back({-shift_ns, name});
  };
  if (const int leap_seconds = LeapSeconds(near_ns); leap_seconds > 0) {
    add(leap_seconds * kSecondNs, "the leap seconds between UTC and GPST");
    add(kTaiLessGpstS * kSecondNs, "TAI in place of GPST");
    add((leap_seconds + kTaiLessGpstS) * kSecondNs, "TAI in place of UTC");
  }
  for (int hours = 1; hours <= kLargestZoneH; ++hours) {
    add(hours * 3600 * kSecondNs, Format("%d h: a time zone", hours));
  }
  add(kDayNs, "a day");
  std::stable_sort(shifts.begin(), shifts.end(), [](const ClockShift& a, const ClockShift& b) {
    return std::abs(a.shift_ns) < std::abs(b.shift_ns);
  });
  return shifts;
}

std::optional<Meeting> ShiftOntoSpan(const TimeSpan& sensor, const TimeSpan& imu) {
  constexpr double kLeastShare = 0.5;
  constexpr double kBetterBy = 0.01;
  std::optional<Meeting> best;
  for (const ClockShift& shift : KnownClockShifts(imu.first_ns)) {
    const double share = CommonShare(sensor, imu, shift.shift_ns);
    if (share >= (best ? best->share + kBetterBy : kLeastShare)) {
      best = Meeting{shift, share};
    }
  }
  return best;
}

std::optional<ClockShift> ShiftOfBothEnds(const TimeSpan& sensor, const TimeSpan& imu) {
  constexpr double kTogetherS = 2;
  std::optional<ClockShift> best;
  double least = 0;
  for (const ClockShift& shift : KnownClockShifts(imu.first_ns)) {
    const double seconds = SecondsBetween(0, shift.shift_ns);
    const double start = std::abs(SecondsBetween(imu.first_ns, sensor.first_ns) + seconds);
    const double end = std::abs(SecondsBetween(imu.last_ns, sensor.last_ns) + seconds);
    if (std::max(start, end) <= kTogetherS && (!best || start + end < least)) {
      best = shift;
      least = start + end;
    }
  }
  return best;
}

}  // namespace alidade
