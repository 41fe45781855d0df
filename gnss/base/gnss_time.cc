#include "gnss/base/gnss_time.h"

#include <algorithm>
#include <array>
#include <chrono>

#include "core/check.h"
#include "core/format.h"

namespace alidade {
namespace {

constexpr TimeNs kGpsEpochNs = 315'964'800 * kSecondNs;       // 1980-01-06
constexpr TimeNs kBeidouEpochNs = 1'136'073'600 * kSecondNs;  // 2006-01-01, a label of BDT
constexpr TimeNs kBeidouOffsetNs = kGpstLessBdtS * kSecondNs;
constexpr TimeNs kTaiOffsetNs = 19 * kSecondNs;           // TAI - GPST
constexpr TimeNs kMoscowOffsetNs = 3 * 3600 * kSecondNs;  // GLONASST - UTC

/// UTC dates from which GPST - UTC grew by one second.
struct LeapDate {
  int year;
  unsigned month;  // the leap second precedes day 1 of this month
};
constexpr std::array<LeapDate, 18> kLeapDates = {{{1981, 7},
                                                  {1982, 7},
                                                  {1983, 7},
                                                  {1985, 7},
                                                  {1988, 1},
                                                  {1990, 1},
                                                  {1991, 1},
                                                  {1992, 7},
                                                  {1993, 7},
                                                  {1994, 7},
                                                  {1996, 1},
                                                  {1997, 7},
                                                  {1999, 1},
                                                  {2006, 1},
                                                  {2009, 1},
                                                  {2012, 7},
                                                  {2015, 7},
                                                  {2017, 1}}};

TimeNs DateNs(int year, unsigned month, unsigned day) {
  const std::chrono::sys_days days =
      std::chrono::year(year) / std::chrono::month(month) / std::chrono::day(day);
  return days.time_since_epoch().count() * kDayNs;
}

/// Labels of UTC at which each leap second has just passed.
const std::array<TimeNs, kLeapDates.size()>& LeapLabels() {
  static const std::array<TimeNs, kLeapDates.size()> labels = [] {
    std::array<TimeNs, kLeapDates.size()> result{};
    for (std::size_t i = 0; i < result.size(); ++i) {
      result[i] = DateNs(kLeapDates[i].year, kLeapDates[i].month, 1);
    }
    return result;
  }();
  return labels;
}

/// GPST of a UTC label; `leap_second` when the label's second is 60.
TimeNs GpsTimeFromUtcLabel(TimeNs label_ns, bool leap_second) {
  const auto& labels = LeapLabels();
  // The label of second 60 equals that of the next midnight, which one leap second more precedes.
  const TimeNs reference = leap_second ? label_ns - kSecondNs : label_ns;
  const auto passed = std::upper_bound(labels.begin(), labels.end(), reference) - labels.begin();
  return label_ns + passed * kSecondNs;
}

Status CheckRanges(const CalendarTime& t) {
  const std::chrono::year_month_day date(std::chrono::year(t.year),
                                         std::chrono::month(static_cast<unsigned>(t.month)),
                                         std::chrono::day(static_cast<unsigned>(t.day)));
  const bool good = t.year >= 1980 && t.year <= 2099 && t.month >= 1 && t.month <= 12 && t.day >= 1 &&
                    t.day <= 31 && date.ok() && t.hour >= 0 && t.hour <= 23 && t.minute >= 0 &&
                    t.minute <= 59 && t.second >= 0 && t.second <= 60 && t.nanoseconds >= 0 &&
                    t.nanoseconds < kSecondNs;
  return good ? Status::Ok()
              : Status::Input(
                    Format("found %d-%d-%d %d:%d:%d, expected a date of 1980 to 2099 and a time of day",
                           t.year, t.month, t.day, t.hour, t.minute, t.second));
}

CalendarTime CalendarOfLabel(TimeNs label_ns) {
  const TimeNs days = (label_ns >= 0 ? label_ns : label_ns - (kDayNs - 1)) / kDayNs;
  const TimeNs of_day = label_ns - days * kDayNs;
  const std::chrono::year_month_day date{std::chrono::sys_days(std::chrono::days(days))};
  CalendarTime t;
  t.year = static_cast<int>(date.year());
  t.month = static_cast<int>(static_cast<unsigned>(date.month()));
  t.day = static_cast<int>(static_cast<unsigned>(date.day()));
  const TimeNs seconds = of_day / kSecondNs;
  t.hour = static_cast<int>(seconds / 3600);
  t.minute = static_cast<int>(seconds / 60 % 60);
  t.second = static_cast<int>(seconds % 60);
  t.nanoseconds = of_day % kSecondNs;
  return t;
}

}  // namespace

int LeapSeconds(TimeNs gpst_ns) {
  const auto& labels = LeapLabels();
  int count = 0;
  // In GPST leap second i ends at its UTC label + i + 1 seconds.
  while (count < static_cast<int>(labels.size()) &&
         gpst_ns >= labels[static_cast<std::size_t>(count)] + (count + 1) * kSecondNs) {
    ++count;
  }
  return count;
}

Result<TimeNs> GpsTimeFromCalendar(TimeScale scale, const CalendarTime& t) {
  ALIDADE_RETURN_IF_ERROR(CheckRanges(t));
  const TimeNs label = DateNs(t.year, static_cast<unsigned>(t.month), static_cast<unsigned>(t.day)) +
                       (t.hour * 3600 + t.minute * 60 + t.second) * kSecondNs + t.nanoseconds;
  switch (scale) {
    case TimeScale::kBeidou:
      return label + kBeidouOffsetNs;
    case TimeScale::kUtc:
      return GpsTimeFromUtcLabel(label, t.second == 60);
    case TimeScale::kGlonass:
      return GpsTimeFromUtcLabel(label - kMoscowOffsetNs, t.second == 60);
    case TimeScale::kTai:
      return label - kTaiOffsetNs;
    case TimeScale::kGps:
    case TimeScale::kGalileo:
    case TimeScale::kQzss:
      break;
  }
  return label;
}

CalendarTime CalendarFromGpsTime(TimeScale scale, TimeNs gpst_ns) {
  switch (scale) {
    case TimeScale::kBeidou:
      return CalendarOfLabel(gpst_ns - kBeidouOffsetNs);
    case TimeScale::kTai:
      return CalendarOfLabel(gpst_ns + kTaiOffsetNs);
    case TimeScale::kUtc:
    case TimeScale::kGlonass: {
      const TimeNs shift = scale == TimeScale::kGlonass ? kMoscowOffsetNs : 0;
      const int leap = LeapSeconds(gpst_ns);
      const bool inside = LeapSeconds(gpst_ns + kSecondNs) > leap;  // the leap second itself
      CalendarTime t = CalendarOfLabel(gpst_ns - (leap + (inside ? 1 : 0)) * kSecondNs + shift);
      t.second += inside ? 1 : 0;
      return t;
    }
    case TimeScale::kGps:
    case TimeScale::kGalileo:
    case TimeScale::kQzss:
      break;
  }
  return CalendarOfLabel(gpst_ns);
}

TimeNs GpsTimeFromWeek(TimeScale scale, int week, TimeNs of_week_ns) {
  CHECK(scale != TimeScale::kUtc && scale != TimeScale::kGlonass && scale != TimeScale::kTai)
      << "has no weeks";
  const TimeNs epoch = scale == TimeScale::kBeidou ? kBeidouEpochNs + kBeidouOffsetNs : kGpsEpochNs;
  return epoch + week * kWeekNs + of_week_ns;
}

WeekTime WeekFromGpsTime(TimeNs gpst_ns) {
  const TimeNs since = gpst_ns - kGpsEpochNs;
  const TimeNs week = (since >= 0 ? since : since - (kWeekNs - 1)) / kWeekNs;
  return {static_cast<int>(week), since - week * kWeekNs};
}

TimeNs NearestTimeOfWeek(TimeScale scale, TimeNs of_week_ns, TimeNs near_ns) {
  const TimeNs any = GpsTimeFromWeek(scale, 0, of_week_ns);
  const TimeNs apart = near_ns - any;
  const TimeNs half = apart >= 0 ? kWeekNs / 2 : -kWeekNs / 2;
  return any + (apart + half) / kWeekNs * kWeekNs;
}

std::optional<TimeScale> ParseTimeScale(std::string_view name) {
  constexpr std::pair<std::string_view, TimeScale> kNames[] = {
      {"GPS", TimeScale::kGps},    {"GAL", TimeScale::kGalileo}, {"QZS", TimeScale::kQzss},
      {"BDT", TimeScale::kBeidou}, {"BDS", TimeScale::kBeidou},  {"UTC", TimeScale::kUtc},
      {"GLO", TimeScale::kUtc},    {"TAI", TimeScale::kTai}};
  for (const auto& [known, scale] : kNames) {
    if (name == known) {
      return scale;
    }
  }
  return std::nullopt;
}

std::string FormatGpsTime(TimeNs gpst_ns, int decimals) {
  CHECK(decimals >= 0 && decimals <= 9);
  TimeNs unit = kSecondNs;
  for (int i = 0; i < decimals; ++i) {
    unit /= 10;
  }
  const TimeNs shifted = gpst_ns + unit / 2;
  const TimeNs down = shifted >= 0 ? shifted / unit * unit : -((-shifted + unit - 1) / unit) * unit;
  const CalendarTime t = CalendarOfLabel(down);
  std::string text =
      Format("%04d/%02d/%02d %02d:%02d:%02d", t.year, t.month, t.day, t.hour, t.minute, t.second);
  if (decimals > 0) {
    text += Format(".%0*lld", decimals, static_cast<long long>(t.nanoseconds / unit));
  }
  return text;
}

}  // namespace alidade
