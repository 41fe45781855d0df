#include "gnss/formats/rinex_epoch_line.h"

namespace alidade {

Result<EpochLine> ParseEpochLine(const LineReader& lines, bool modern, TimeScale scale) {
  const std::string_view line = lines.line();
  if (modern && !line.starts_with('>')) {
    return lines.Fault("found " + Excerpt(line) + ", expected an epoch that begins with '>'");
  }
  const std::size_t date_start = modern ? 1 : 0;
  const std::size_t date_end = modern ? 29 : 26;
  EpochLine epoch;
  const std::optional<int> flag = ParseInteger(Field(line, modern ? 29 : 26, 3));
  const std::string_view count_field = Field(line, modern ? 32 : 29, 3);
  const std::optional<int> count =
      count_field.empty() && flag.value_or(0) > 1 ? 0 : ParseInteger(count_field);
  if (!flag || *flag < 0 || *flag > 6 || !count || *count < 0) {
    return lines.Fault("found " + Excerpt(line) + ", expected an epoch with a flag of 0 to 6 and a count");
  }
  epoch.flag = *flag;
  epoch.count = *count;
  const std::string_view date = Field(line, date_start, date_end - date_start);
  if (date.empty() && epoch.flag > 1) {
    return epoch;  // an event may have no time
  }
  const Result<CalendarTime> label = ParseCalendar(date);
  if (!label.ok()) {
    return lines.Fault("epoch: " + label.message());
  }
  const Result<TimeNs> stamp = GpsTimeFromCalendar(scale, *label);
  if (!stamp.ok()) {
    return lines.Fault("epoch: " + stamp.message());
  }
  epoch.stamp_ns = *stamp;
  return epoch;
}

}  // namespace alidade
