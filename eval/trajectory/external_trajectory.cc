#include "eval/trajectory/external_trajectory.h"

#include <Eigen/Geometry>
#include <cmath>

#include "eval/files/csv.h"
#include "eval/files/decimal_stamp.h"
#include "eval/files/input_file.h"
#include "eval/trajectory/position_file_reader.h"
#include "eval/trajectory/trajectory_reader.h"

namespace alidade {
namespace {

constexpr double kMaxNormError = 1e-2;
constexpr size_t kKittiColumns = 12;

/// Where the columns of a row format are; counted from 0, three or four from there.
struct RowLayout {
  char separator = ' ';
  size_t position = 1;
  size_t quaternion = 4;
  bool w_first = false;
  size_t columns = 8;  ///< at least
};

/// The first line that is not blank, and whether it is a comment.
struct FirstLine {
  std::string text;
  bool comment = false;
};

FirstLine FirstOf(const std::string& content) {
  for (size_t start = 0; start < content.size();) {
    const size_t end = std::min(content.find('\n', start), content.size());
    const std::string line = content.substr(start, end - start);
    if (line.find_first_not_of(" \t\r") != std::string::npos) {
      return {line, line.front() == '#'};
    }
    start = end + 1;
  }
  return {};
}

Status ReadNumbers(const CsvReader& csv, size_t first, size_t count, const char* name, double* values) {
  for (size_t i = 0; i < count; ++i) {
    ALIDADE_RETURN_IF_ERROR(csv.ReadReal(first + i, name, &values[i]));
  }
  return Status::Ok();
}

/// A stamp as integer nanoseconds, or as decimal seconds: nothing in seconds is as large as the former.
Status ReadAnyStamp(const CsvReader& csv, const Trajectory& before, TimeNs* stamp_ns) {
  constexpr size_t kDigitsOfNanoseconds = 16;
  const std::string text(csv.field(0));
  const bool nanoseconds =
      text.size() >= kDigitsOfNanoseconds && text.find_first_of(".eE") == std::string::npos;
  if (nanoseconds) {
    ALIDADE_RETURN_IF_ERROR(csv.ReadTime(0, "stamp", stamp_ns));
  } else if (!ParseDecimalSeconds(text, stamp_ns)) {
    return csv.Fault(0, "stamp", "decimal seconds or nanoseconds");
  }
  return before.points.empty() || *stamp_ns > before.points.back().stamp_ns
             ? Status::Ok()
             : csv.Fault(0, "stamp", "a stamp later than that of the row before");
}

Result<Trajectory> ReadRows(const std::string& path, const RowLayout& layout) {
  Result<CsvReader> csv = CsvReader::Open(path, layout.separator);
  ALIDADE_RETURN_IF_ERROR(csv.status());
  Trajectory trajectory;
  while (csv->NextRow()) {
    if (csv->field(0).starts_with('#')) {
      continue;
    }
    if (csv->columns() < layout.columns) {
      ALIDADE_RETURN_IF_ERROR(csv->ExpectColumns(layout.columns));
    }
    TrajectoryPoint point;
    ALIDADE_RETURN_IF_ERROR(ReadAnyStamp(*csv, trajectory, &point.stamp_ns));
    ALIDADE_RETURN_IF_ERROR(ReadNumbers(*csv, layout.position, 3, "position", point.nav.p_WB.data()));
    double q[4];
    ALIDADE_RETURN_IF_ERROR(ReadNumbers(*csv, layout.quaternion, 4, "quaternion", q));
    const Eigen::Quaterniond quaternion = layout.w_first ? Eigen::Quaterniond(q[0], q[1], q[2], q[3])
                                                         : Eigen::Quaterniond(q[3], q[0], q[1], q[2]);
    if (!(std::abs(quaternion.norm() - 1) <= kMaxNormError)) {
      return csv->Fault(layout.quaternion, "quaternion", "four numbers of norm 1");
    }
    point.nav.R_WB = quaternion.normalized().toRotationMatrix();
    trajectory.points.push_back(point);
  }
  return trajectory;
}

Result<Trajectory> ReadKitti(const std::string& path, const std::vector<TimeNs>& stamps) {
  Result<CsvReader> csv = CsvReader::Open(path, ' ');
  ALIDADE_RETURN_IF_ERROR(csv.status());
  Trajectory trajectory;
  while (csv->NextRow()) {
    ALIDADE_RETURN_IF_ERROR(csv->ExpectColumns(kKittiColumns));
    Eigen::Matrix<double, 3, 4, Eigen::RowMajor> pose;
    ALIDADE_RETURN_IF_ERROR(ReadNumbers(*csv, 0, kKittiColumns, "pose", pose.data()));
    const Eigen::Matrix3d rotation = pose.leftCols<3>();
    if (!(rotation.transpose() * rotation).isIdentity(kMaxNormError)) {
      return csv->Fault(0, "pose", "a row-major [R p] with a rotation");
    }
    if (trajectory.points.size() < stamps.size()) {
      TrajectoryPoint point;
      point.stamp_ns = stamps[trajectory.points.size()];
      point.nav.R_WB = so3::Normalize(rotation);
      point.nav.p_WB = pose.col(3);
      trajectory.points.push_back(point);
    } else {
      return csv->Fault(
          0, "row",
          "one row a camera stamp of the sequence, of which there are " + std::to_string(stamps.size()));
    }
  }
  if (trajectory.points.size() != stamps.size()) {
    return Status::Input(path + ": found " + std::to_string(trajectory.points.size()) +
                         " rows, expected one a camera stamp of the sequence, " +
                         std::to_string(stamps.size()));
  }
  return trajectory;
}

Result<Trajectory> ReadByContent(const std::string& path, ExternalContext* context) {
  if (path.ends_with(".pos")) {
    return ReadPositionFile(path, context->gnss_time_offset_s, &context->anchor_E);
  }
  const Result<std::string> content = ReadWholeFile(path);
  ALIDADE_RETURN_IF_ERROR(content.status());
  const FirstLine first = FirstOf(*content);
  if (first.comment && first.text.starts_with("# timestamp(s) q")) {
    return ReadRows(path, {' ', 5, 1, false, 8});
  }
  if (first.comment && first.text.starts_with("# timestamp(s) tx")) {
    return ReadRows(path, {' ', 1, 4, false, 8});
  }
  const bool has_commas = first.text.find(',') != std::string::npos;
  const bool has_header = first.text.find_first_not_of("0123456789+-.eE, \t\r") != std::string::npos;
  if (has_commas && !has_header) {
    return ReadRows(path, {',', 1, 4, true, 8});
  }
  Result<CsvReader> csv = CsvReader::Open(path, ' ');
  if (csv.ok() && csv->NextRow() && csv->columns() == kKittiColumns && !has_header) {
    return ReadKitti(path, context->camera_stamps);
  }
  return ReadTrajectory(path);
}

}  // namespace

Result<Trajectory> ReadExternalTrajectory(const std::string& path, ExternalContext* context) {
  Result<Trajectory> trajectory = ReadByContent(path, context);
  if (trajectory.ok() && trajectory->points.empty()) {
    return Status::Input(path + ": holds no pose, expected at least one row");
  }
  if (trajectory.ok() && context->T_BC) {
    if (!trajectory->has_orientation) {
      return Status::Input(
          path + ": holds no orientation, which is needed to convert camera positions to body positions");
    }
    const Pose T_CB = context->T_BC->Inverse();
    for (TrajectoryPoint& point : trajectory->points) {
      point.nav.p_WB += point.nav.R_WB * T_CB.translation;
      point.nav.R_WB = point.nav.R_WB * T_CB.rotation;
    }
  }
  return trajectory;
}

}  // namespace alidade
