#include "eval/trajectory/position_file_reader.h"

#include <numbers>

#include "core/format.h"
#include "gnss/base/geodesy.h"
#include "gnss/base/gnss_time.h"
#include "gnss/base/text_file.h"

namespace alidade {
namespace {

/// What the header says about the rows.
struct PositionLayout {
  bool ecef = false;
  bool utc = false;
};

/// "2020/06/25 00:00:00.000" or "2111 432000.000", taken off the front of a row.
Result<TimeNs> TakeStamp(const PositionLayout& layout, std::string_view* row) {
  const std::string_view first = NextWord(row);
  const std::string_view second = NextWord(row);
  if (first.find('/') == std::string_view::npos) {
    const std::optional<int> week = ParseInteger(first);
    const std::optional<double> of_week = ParseReal(second);
    if (!week || *week < 0 || *week > 5000 || !of_week || !(*of_week >= 0 && *of_week <= 604800)) {
      return Status::Input("found " + Excerpt(std::string(first) + " " + std::string(second)) +
                           ", expected a date and time, or week and second of week");
    }
    return GpsTimeFromWeek(TimeScale::kGps, *week, SecondsToNs(*of_week));
  }
  std::string label = std::string(first) + " " + std::string(second);
  for (char& c : label) {
    c = c == '/' || c == ':' ? ' ' : c;
  }
  const Result<CalendarTime> calendar = ParseCalendar(label);
  ALIDADE_RETURN_IF_ERROR(calendar.status());
  return GpsTimeFromCalendar(layout.utc ? TimeScale::kUtc : TimeScale::kGps, *calendar);
}

Result<Eigen::Vector3d> TakePosition(const PositionLayout& layout, std::string_view* row) {
  Eigen::Vector3d v;
  for (int i = 0; i < 3; ++i) {
    const std::string_view word = NextWord(row);
    const std::optional<double> number = ParseReal(word);
    if (!number) {
      return Status::Input("found " + Excerpt(word) + ", expected three coordinates");
    }
    v[i] = *number;
  }
  constexpr double kRadians = std::numbers::pi / 180;
  if (!layout.ecef && (std::abs(v[0]) > 90 || std::abs(v[1]) > 360)) {
    return Status::Input("found " + Format("%g, %g", v[0], v[1]) + ", expected latitude and longitude [deg]");
  }
  const Eigen::Vector3d position_E = layout.ecef ? v : ToEcef({v[0] * kRadians, v[1] * kRadians, v[2]});
  constexpr double kLeastRadiusM = 6.3e6;
  if (position_E.norm() < kLeastRadiusM || position_E.norm() > 1.1 * kLeastRadiusM) {
    return Status::Input("a position " + Format("%.0f m", position_E.norm()) + " from the Earth's centre");
  }
  return position_E;
}

}  // namespace

Result<Trajectory> ReadPositionFile(const std::string& path, double time_offset_s,
                                    std::optional<Eigen::Vector3d>* anchor_E) {
  const Result<std::string> text = ReadTextFile(path);
  ALIDADE_RETURN_IF_ERROR(text.status());
  Trajectory trajectory;
  trajectory.has_orientation = false;
  PositionLayout layout;
  EnuFrame enu;
  LineReader lines(path, *text);
  while (lines.Next()) {
    std::string_view row = lines.trimmed();
    if (row.empty() || row.front() == '%') {
      layout.ecef = layout.ecef || row.find("x-ecef") != std::string_view::npos;
      layout.utc = layout.utc || row.find(" UTC ") != std::string_view::npos;
      continue;
    }
    const Result<TimeNs> stamp = TakeStamp(layout, &row);
    if (!stamp.ok()) {
      return lines.Fault(stamp.message());
    }
    const Result<Eigen::Vector3d> position_E = TakePosition(layout, &row);
    if (!position_E.ok()) {
      return lines.Fault(position_E.message());
    }
    if (trajectory.points.empty()) {
      *anchor_E = anchor_E->value_or(*position_E);
      enu = EnuFrame::At(**anchor_E);
    }
    TrajectoryPoint point;
    point.stamp_ns = *stamp + SecondsToNs(time_offset_s);
    point.nav.p_WB = enu.FromEcef(*position_E);
    if (trajectory.points.empty() || point.stamp_ns > trajectory.points.back().stamp_ns) {
      trajectory.points.push_back(point);
    }
  }
  if (trajectory.points.empty()) {
    return Status::Input(path + ": holds no position, expected at least one row");
  }
  return trajectory;
}

}  // namespace alidade
