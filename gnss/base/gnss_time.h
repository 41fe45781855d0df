#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "core/status.h"
#include "core/time.h"

namespace alidade {

// Every stamp inside gnss/ is GPST as TimeNs: the nanoseconds since the GPST calendar label 1970-01-01
// 00:00:00, so that t = (315964800 + 604800 week + seconds of week) 1e9, without leap seconds. It is what a
// converter makes of a RINEX epoch that it takes for a UTC calendar date; UTC itself is LeapSeconds() less.

/// GPST - BDT.
constexpr int kGpstLessBdtS = 14;

/// Time scales of GNSS files.
///   kGps      GPST, no leap seconds, week 0 begins 1980-01-06
///   kGalileo  GST, taken equal to GPST (broadcast GGTO, some ns, is left to the inter-system biases)
///   kQzss     QZSST = GPST
///   kBeidou   BDT = GPST - 14 s, week 0 begins 2006-01-01
///   kUtc      with leap seconds
///   kGlonass  GLONASST = UTC + 3 h; "GLO" in RINEX files means UTC
///   kTai      TAI = GPST + 19 s (SP3)
enum class TimeScale { kGps, kGalileo, kQzss, kBeidou, kUtc, kGlonass, kTai };

/// A date and time of day as a label of some scale.
struct CalendarTime {
  int year = 1970;
  int month = 1;  ///< 1..12
  int day = 1;    ///< 1..31
  int hour = 0;
  int minute = 0;
  int second = 0;                ///< 0..60: 60 in a leap second of UTC
  std::int64_t nanoseconds = 0;  ///< 0..999 999 999
};

/// Week and time of week of GPST or BDT.
struct WeekTime {
  int week = 0;
  TimeNs of_week_ns = 0;  ///< 0 <= of_week_ns < 604800e9
};

inline constexpr TimeNs kDayNs = 86'400 * kSecondNs;
inline constexpr TimeNs kWeekNs = 7 * kDayNs;

/// GPST - UTC [s] at a GPST stamp, from the table of leap seconds 1981..2017 (IERS Bulletin C; none since).
/// 0 before 1981.
[[nodiscard]] int LeapSeconds(TimeNs gpst_ns);

/// The GPST stamp of a calendar label of `scale`. Errors: a field out of range, or a year outside 1980..2099.
Result<TimeNs> GpsTimeFromCalendar(TimeScale scale, const CalendarTime& label);
/// The label of a GPST stamp in `scale`. UTC during a leap second reads 23:59:60.
[[nodiscard]] CalendarTime CalendarFromGpsTime(TimeScale scale, TimeNs gpst_ns);

/// The GPST stamp of a week and time of week of `scale`, one of kGps, kGalileo (counted from 1980 as in
/// RINEX), kQzss, kBeidou.
[[nodiscard]] TimeNs GpsTimeFromWeek(TimeScale scale, int week, TimeNs of_week_ns);
[[nodiscard]] WeekTime WeekFromGpsTime(TimeNs gpst_ns);

/// The stamp with this time of week (of `scale`) that is nearest to `near_ns`: files disagree about the week
/// number around its end.
[[nodiscard]] TimeNs NearestTimeOfWeek(TimeScale scale, TimeNs of_week_ns, TimeNs near_ns);

/// "GPS", "GAL", "QZS", "BDT", "UTC", "GLO" (UTC: see above), "TAI" of RINEX and SP3 headers.
[[nodiscard]] std::optional<TimeScale> ParseTimeScale(std::string_view name);

/// "2020/06/25 00:00:00.000": label in GPST, rounded to `decimals` (0..9) of a second.
[[nodiscard]] std::string FormatGpsTime(TimeNs gpst_ns, int decimals);

}  // namespace alidade
