#include "eval/trajectory/position_file_reader.h"

#include <array>
#include <cmath>
#include <numbers>

#include "core/dense_solvers.h"
#include "core/format.h"
#include "gnss/base/geodesy.h"
#include "gnss/base/gnss_time.h"
#include "gnss/base/text_file.h"

namespace alidade {
namespace {

/// What the header states about the rows.
struct PositionLayout {
  bool ecef = false;
  bool utc = false;
};

/// "latitude(deg)": a name and its unit.
bool IsLabel(std::string_view word) {
  const std::size_t unit = word.find('(');
  return unit != std::string_view::npos && unit > 0 && word.back() == ')';
}

/// Takes in a line of the header. What is wrong with it, or nothing.
std::string TakeHeader(std::string_view line, PositionLayout* layout) {
  std::string_view rest = line.substr(line.empty() ? 0 : 1);
  const std::string_view first = NextWord(&rest);
  const std::string_view second = NextWord(&rest);
  const std::string_view coordinate = IsLabel(first) ? first : second;
  if (!IsLabel(coordinate)) {  // not the line of the labels
    layout->ecef = layout->ecef || line.find("x-ecef") != std::string_view::npos;
    layout->utc = layout->utc || line.find(" UTC ") != std::string_view::npos;
    return {};
  }
  if (!IsLabel(first)) {
    if (first != "GPST" && first != "UTC") {
      return "found " + Excerpt(first) + ", expected the time scale GPST or UTC";
    }
    layout->utc = first == "UTC";
  }
  if (coordinate != "latitude(deg)" && coordinate != "x-ecef(m)") {
    return "found " + Excerpt(coordinate) +
           ", expected latitude(deg) or x-ecef(m) as label of the first coordinate";
  }
  layout->ecef = coordinate == "x-ecef(m)";
  return {};
}

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

/// Deviation of a solution of quality Q [m].
double UsualDeviation(int quality) {
  switch (quality) {
    case 1:
      return 0.02;
    case 2:
      return 0.3;
    case 3:
    case 4:
      return 1;
    case 6:
      return 0.1;
    default:
      return 3;
  }
}

/// The covariance of the columns Q, number of satellites, three deviations and the signed roots of the three
/// covariances.
Eigen::Matrix3d TakeCovariance(const PositionLayout& layout, const Eigen::Vector3d& position_E,
                               std::string_view* row) {
  const int quality = ParseInteger(NextWord(row)).value_or(0);
  static_cast<void>(NextWord(row));
  std::array<double, 6> roots{};
  for (double& root : roots) {
    root = ParseReal(NextWord(row)).value_or(0);
  }
  const auto square = [&](std::size_t i) { return std::copysign(roots[i] * roots[i], roots[i]); };
  // Of x, y, z in ECEF, else of north, east, up: xy, yz, zx and ne, eu, un.
  Eigen::Matrix3d covariance;
  covariance << square(0), square(3), square(5),  //
      square(3), square(1), square(4),            //
      square(5), square(4), square(2);
  const Eigen::Vector3d diagonal = covariance.diagonal();
  if (!(diagonal.minCoeff() > 0)) {
    const double deviation = UsualDeviation(quality);
    return CovarianceFromDeviations(position_E, {deviation, deviation, 2 * deviation});
  }
  if (!IsPositiveDefinite(covariance)) {
    covariance = diagonal.asDiagonal();  // the file rounds them
  }
  if (layout.ecef) {
    return covariance;
  }
  Eigen::Matrix3d enu_from_neu;
  enu_from_neu << 0, 1, 0, 1, 0, 0, 0, 0, 1;
  const Eigen::Matrix3d axes = EnuFrame::At(position_E).R_EN * enu_from_neu;
  return axes * covariance * axes.transpose();
}

}  // namespace

Eigen::Matrix3d CovarianceFromDeviations(const Eigen::Vector3d& position_E,
                                         const Eigen::Vector3d& deviations_enu_m) {
  const Eigen::Matrix3d R_EN = EnuFrame::At(position_E).R_EN;
  return R_EN * deviations_enu_m.cwiseAbs2().asDiagonal() * R_EN.transpose();
}

Result<std::vector<FilePosition>> ReadPositionRows(const std::string& path) {
  const Result<std::string> text = ReadTextFile(path);
  ALIDADE_RETURN_IF_ERROR(text.status());
  std::vector<FilePosition> positions;
  PositionLayout layout;
  LineReader lines(path, *text);
  while (lines.Next()) {
    std::string_view row = lines.trimmed();
    if (row.empty() || row.front() == '%') {
      if (const std::string wrong = TakeHeader(row, &layout); !wrong.empty()) {
        return lines.Fault(wrong);
      }
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
    if (positions.empty() || *stamp > positions.back().stamp_ns) {
      positions.push_back({*stamp, *position_E, TakeCovariance(layout, *position_E, &row)});
    }
  }
  return positions.empty() ? Status::Input(path + ": holds no position, expected at least one row")
                           : Result<std::vector<FilePosition>>(std::move(positions));
}

Result<Trajectory> ReadPositionFile(const std::string& path, double time_offset_s,
                                    std::optional<Eigen::Vector3d>* anchor_E) {
  const Result<std::vector<FilePosition>> positions = ReadPositionRows(path);
  ALIDADE_RETURN_IF_ERROR(positions.status());
  *anchor_E = anchor_E->value_or(positions->front().position_E);
  const EnuFrame enu = EnuFrame::At(**anchor_E);
  Trajectory trajectory;
  trajectory.has_orientation = false;
  for (const FilePosition& position : *positions) {
    TrajectoryPoint point;
    point.stamp_ns = position.stamp_ns + SecondsToNs(time_offset_s);
    point.nav.p_WB = enu.FromEcef(position.position_E);
    trajectory.points.push_back(point);
  }
  return trajectory;
}

}  // namespace alidade
