#include "eval/trajectory/nmea_reader.h"

#include <charconv>
#include <map>
#include <numbers>

#include "gnss/base/geodesy.h"
#include "gnss/base/text_file.h"

namespace alidade {
namespace {

constexpr int kRtkFixed = 4;
constexpr int kRtkFloat = 5;

/// A GGA sentence; its day is found later.
struct Position {
  TimeNs of_day_ns = 0;
  GeodeticPosition geodetic;
  int quality = 0;
  double hdop = 1;
  std::optional<TimeNs> utc_ns;  ///< midnight of its day and time of day, as label
};

std::vector<std::string_view> Split(std::string_view sentence) {
  std::vector<std::string_view> fields;
  for (;;) {
    const std::size_t comma = sentence.find(',');
    fields.push_back(sentence.substr(0, comma));
    if (comma == std::string_view::npos) {
      return fields;
    }
    sentence.remove_prefix(comma + 1);
  }
}

/// The sentence between '$' and '*', or nothing when it is none or its checksum is wrong.
std::optional<std::string_view> SentenceIn(std::string_view line) {
  if (line.empty() || line.front() != '$') {
    return std::nullopt;
  }
  line.remove_prefix(1);
  const std::size_t star = line.find('*');
  if (star == std::string_view::npos) {
    return line;
  }
  unsigned sum = 0;
  for (const char c : line.substr(0, star)) {
    sum ^= static_cast<unsigned char>(c);
  }
  unsigned stated = 0;
  const std::string_view digits = line.substr(star + 1, 2);
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), stated, 16);
  const bool right =
      error == std::errc() && end == digits.data() + digits.size() && digits.size() == 2 && stated == sum;
  return right ? std::optional(line.substr(0, star)) : std::nullopt;
}

/// "hhmmss.ss"
std::optional<TimeNs> TimeOfDay(std::string_view field) {
  if (field.size() < 6) {
    return std::nullopt;
  }
  const std::optional<int> hour = ParseInteger(field.substr(0, 2));
  const std::optional<int> minute = ParseInteger(field.substr(2, 2));
  const std::optional<double> second = ParseReal(field.substr(4));
  if (!hour || !minute || !second || *hour < 0 || *hour > 23 || *minute < 0 || *minute > 59 ||
      !(*second >= 0) || *second >= 61) {
    return std::nullopt;
  }
  return (*hour * 3600 + *minute * 60) * kSecondNs + SecondsToNs(*second);
}

/// "ddmm.mmmm" and a letter: radians, the second letter of `signs` negative.
std::optional<double> Angle(std::string_view field, std::string_view letter, std::string_view signs) {
  const std::optional<double> number = ParseReal(field);
  if (!number || *number < 0 || letter.size() != 1 || signs.find(letter) == std::string_view::npos) {
    return std::nullopt;
  }
  const double degrees = std::floor(*number / 100);
  const double angle = degrees + (*number - 100 * degrees) / 60;
  return (letter.front() == signs[1] ? -angle : angle) * std::numbers::pi / 180;
}

/// Midnight of a day as a label, which the arithmetic of days needs: the nanoseconds since 1970 without leap
/// seconds.
std::optional<TimeNs> Midnight(int year, int month, int day) {
  CalendarTime label;
  label.year = year;
  label.month = month;
  label.day = day;
  const Result<TimeNs> stamp = GpsTimeFromCalendar(TimeScale::kGps, label);
  return stamp.ok() ? std::optional(*stamp) : std::nullopt;
}

/// The label with this time of day that is nearest to another one.
TimeNs NearestTo(TimeNs near_ns, TimeNs of_day_ns) {
  const TimeNs midnight = near_ns / kDayNs * kDayNs;
  TimeNs label = midnight + of_day_ns;
  if (label - near_ns > kDayNs / 2) {
    label -= kDayNs;
  } else if (near_ns - label > kDayNs / 2) {
    label += kDayNs;
  }
  return label;
}

/// UTC label to GPST.
TimeNs GpstOf(TimeNs label_ns) {
  CalendarTime label = CalendarFromGpsTime(TimeScale::kGps, label_ns);
  return GpsTimeFromCalendar(TimeScale::kUtc, label).value();
}

class NmeaReader {
 public:
  explicit NmeaReader(const std::optional<CalendarTime>& date) {
    if (date) {
      given_midnight_ = Midnight(date->year, date->month, date->day);
    }
  }

  /// What is wrong with a sentence, or nothing.
  std::string Take(const std::vector<std::string_view>& fields) {
    const std::string_view type = fields[0].size() == 5 ? fields[0].substr(2) : std::string_view();
    if (type == "GGA") {
      return TakePosition(fields);
    }
    if (type == "RMC" && fields.size() > 9 && !fields[9].empty()) {
      constexpr std::size_t kDateLength = 6;  // ddmmyy
      if (fields[9].size() < kDateLength) {
        return "expected time and date";
      }
      return TakeDate(fields[1], fields[9].substr(0, 2), fields[9].substr(2, 2), fields[9].substr(4));
    }
    if (type == "ZDA" && fields.size() > 4 && !fields[4].empty()) {
      return TakeDate(fields[1], fields[2], fields[3], fields[4]);
    }
    if (type == "GST" && fields.size() > 8 && !fields[6].empty()) {
      return TakeDeviations(fields);
    }
    return {};
  }

  Result<std::vector<FilePosition>> Finish(const std::string& path) {
    if (!last_utc_ns_ && !positions_.empty()) {
      if (!given_midnight_) {
        return Status::Input(
            path +
            ": holds no date (no RMC and no ZDA sentence), expected the key date: YYYY-MM-DD, UTC, "
            "in sensor.yaml");
      }
      SetTime(*given_midnight_ + positions_.front().of_day_ns);
      for (Position& position : positions_) {
        position.utc_ns = NearestTo(*last_utc_ns_, position.of_day_ns);
        last_utc_ns_ = position.utc_ns;
      }
    }
    std::vector<FilePosition> result;
    for (const Position& position : positions_) {
      const TimeNs stamp_ns = GpstOf(*position.utc_ns);
      if (result.empty() || stamp_ns > result.back().stamp_ns) {
        const Eigen::Vector3d position_E = ToEcef(position.geodetic);
        result.push_back({stamp_ns, position_E, CovarianceFromDeviations(position_E, Deviations(position))});
      }
    }
    return result.empty()
               ? Status::Input(path + ": holds no position, expected GGA sentences with a solution")
               : Result<std::vector<FilePosition>>(std::move(result));
  }

 private:
  void SetTime(TimeNs utc_ns) {
    last_utc_ns_ = utc_ns;
    // Backwards: positions before the first date are near to each other, and the last of them to the date.
    TimeNs near_ns = utc_ns;
    for (auto position = positions_.rbegin(); position != positions_.rend() && !position->utc_ns;
         ++position) {
      position->utc_ns = near_ns = NearestTo(near_ns, position->of_day_ns);
    }
  }

  std::string TakePosition(const std::vector<std::string_view>& fields) {
    if (fields.size() < 12) {
      return "expected at least 11 fields after GGA";
    }
    Position position;
    position.quality = ParseInteger(fields[6]).value_or(-1);
    if (position.quality < 0) {
      return "found " + Excerpt(fields[6]) + ", expected the quality as a number";
    }
    constexpr int kDeadReckoning = 6;
    constexpr int kManual = 7;
    if (position.quality == 0 || position.quality == kDeadReckoning || position.quality == kManual) {
      return {};
    }
    const std::optional<TimeNs> of_day = TimeOfDay(fields[1]);
    const std::optional<double> latitude = Angle(fields[2], fields[3], "NS");
    const std::optional<double> longitude = Angle(fields[4], fields[5], "EW");
    const std::optional<double> altitude = ParseReal(fields[9]);
    const std::optional<double> separation = fields[11].empty() ? std::optional(0.0) : ParseReal(fields[11]);
    if (!of_day || !latitude || !longitude || !altitude || !separation || std::abs(*latitude) > M_PI / 2) {
      return "expected time, latitude, longitude, height above the geoid and the geoid's separation";
    }
    position.of_day_ns = *of_day;
    position.geodetic = {*latitude, *longitude, *altitude + *separation};
    position.hdop = std::max(ParseReal(fields[8]).value_or(1), 0.5);
    if (last_utc_ns_) {
      position.utc_ns = last_utc_ns_ = NearestTo(*last_utc_ns_, position.of_day_ns);
    }
    positions_.push_back(position);
    return {};
  }

  std::string TakeDate(std::string_view time, std::string_view day, std::string_view month,
                       std::string_view year) {
    const std::optional<TimeNs> of_day = TimeOfDay(time);
    const std::optional<int> d = ParseInteger(day);
    const std::optional<int> m = ParseInteger(month);
    const std::optional<int> y = ParseInteger(year);
    if (!of_day || !d || !m || !y) {
      return "expected time and date";
    }
    const int full_year = *y >= 100 ? *y : *y + (*y < 80 ? 2000 : 1900);
    const std::optional<TimeNs> midnight = Midnight(full_year, *m, *d);
    if (!midnight) {
      return "expected a date";
    }
    SetTime(*midnight + *of_day);
    return {};
  }

  std::string TakeDeviations(const std::vector<std::string_view>& fields) {
    const std::optional<TimeNs> of_day = TimeOfDay(fields[1]);
    const std::optional<double> north = ParseReal(fields[6]);
    const std::optional<double> east = ParseReal(fields[7]);
    const std::optional<double> up = ParseReal(fields[8]);
    if (!of_day || !north || !east || !up) {
      return "expected time and deviations of latitude, longitude and height";
    }
    if (*north > 0 && *east > 0 && *up > 0) {
      deviations_[*of_day] = {*east, *north, *up};
    }
    return {};
  }

  [[nodiscard]] Eigen::Vector3d Deviations(const Position& position) const {
    if (const auto found = deviations_.find(position.of_day_ns); found != deviations_.end()) {
      return found->second;
    }
    constexpr int kDifferential = 2;
    const double deviation = position.quality == kRtkFixed       ? 0.02
                             : position.quality == kRtkFloat     ? 0.3
                             : position.quality == kDifferential ? 0.7 * position.hdop
                                                                 : 2.5 * position.hdop;
    return {deviation, deviation, 2 * deviation};
  }

  std::optional<TimeNs> given_midnight_;
  std::optional<TimeNs> last_utc_ns_;  ///< as label
  std::vector<Position> positions_;
  std::map<TimeNs, Eigen::Vector3d> deviations_;  ///< by time of day
};

}  // namespace

Result<std::vector<FilePosition>> ReadNmeaFile(const std::string& path,
                                               const std::optional<CalendarTime>& date) {
  const Result<std::string> text = ReadTextFile(path);
  ALIDADE_RETURN_IF_ERROR(text.status());
  NmeaReader reader(date);
  LineReader lines(path, *text);
  while (lines.Next()) {
    const std::optional<std::string_view> sentence = SentenceIn(lines.trimmed());
    if (!sentence) {
      continue;
    }
    if (const std::string wrong = reader.Take(Split(*sentence)); !wrong.empty()) {
      return lines.Fault("found " + Excerpt(*sentence) + ", " + wrong);
    }
  }
  return reader.Finish(path);
}

}  // namespace alidade
