#include "eval/trajectory/trajectory_reader.h"

#include <cmath>
#include <string>
#include <utility>

#include "eval/files/csv.h"
#include "eval/files/decimal_stamp.h"
#include "eval/trajectory/pose_covariance.h"
#include "eval/trajectory/truth_covariance.h"

namespace alidade {
namespace {

using TakePoint = std::function<void(const TrajectoryPoint&)>;

constexpr double kMaxQuaternionNormError = 1e-2;
constexpr size_t kPoseColumns = 8;
constexpr size_t kStateColumns = 17;

const std::vector<CsvColumn>& PoseHeader() {
  static const std::vector<CsvColumn> kHeader = {
      {"timestamp", "ns"}, {"p_x", "m"}, {"p_y", "m"}, {"p_z", "m"}, {"q_w"}, {"q_x"}, {"q_y"}, {"q_z"}};
  return kHeader;
}

const std::vector<CsvColumn>& EurocHeader() {
  static const std::vector<CsvColumn> kHeader = {{"timestamp", "ns"},
                                                 {"p_RS_R_x", "m"},
                                                 {"p_RS_R_y", "m"},
                                                 {"p_RS_R_z", "m"},
                                                 {"q_RS_w", ""},
                                                 {"q_RS_x", ""},
                                                 {"q_RS_y", ""},
                                                 {"q_RS_z", ""},
                                                 {"v_RS_R_x", "m s^-1"},
                                                 {"v_RS_R_y", "m s^-1"},
                                                 {"v_RS_R_z", "m s^-1"},
                                                 {"b_w_RS_S_x", "rad s^-1"},
                                                 {"b_w_RS_S_y", "rad s^-1"},
                                                 {"b_w_RS_S_z", "rad s^-1"},
                                                 {"b_a_RS_S_x", "m s^-2"},
                                                 {"b_a_RS_S_y", "m s^-2"},
                                                 {"b_a_RS_S_z", "m s^-2"}};
  return kHeader;
}

const std::vector<CsvColumn>& StatesHeader() {
  static const std::vector<CsvColumn> kHeader = [] {
    std::vector<CsvColumn> header = {{"timestamp_ns"}, {"p_x"},  {"p_y"},  {"p_z"},  {"q_w"}, {"q_x"},
                                     {"q_y"},          {"q_z"},  {"v_x"},  {"v_y"},  {"v_z"}, {"bg_x"},
                                     {"bg_y"},         {"bg_z"}, {"ba_x"}, {"ba_y"}, {"ba_z"}};
    for (const std::string_view name : PoseCovarianceNames()) {
      header.push_back({name});
    }
    return header;
  }();
  return kHeader;
}

/// Reads columns first .. first + 2.
Status ReadVector(const CsvReader& csv, size_t first, std::string_view name, Eigen::Vector3d* vector) {
  for (size_t i = 0; i < 3; ++i) {
    ALIDADE_RETURN_IF_ERROR(csv.ReadReal(first + i, name, &(*vector)[static_cast<Eigen::Index>(i)]));
  }
  return Status::Ok();
}

/// Reads the quaternion's columns; `w_last` for TUM's order.
Status ReadRotation(const CsvReader& csv, size_t first, bool w_last, Eigen::Matrix3d* rotation) {
  double q[4] = {};
  for (size_t i = 0; i < 4; ++i) {
    ALIDADE_RETURN_IF_ERROR(csv.ReadReal(first + i, "quaternion", &q[i]));
  }
  const Eigen::Quaterniond quaternion =
      w_last ? Eigen::Quaterniond(q[3], q[0], q[1], q[2]) : Eigen::Quaterniond(q[0], q[1], q[2], q[3]);
  const double norm = quaternion.norm();
  if (!(std::abs(norm - 1) <= kMaxQuaternionNormError)) {
    return Status::Input(csv.Place() + ": columns " + std::to_string(first + 1) + " to " +
                         std::to_string(first + 4) + ": quaternion of norm " + std::to_string(norm) +
                         ", expected 1 within 1e-2");
  }
  *rotation = quaternion.normalized().toRotationMatrix();
  return Status::Ok();
}

constexpr size_t kPositionColumns = 4;

/// One row of the three comma-separated formats: they share their first columns. `point`: that of the row
/// before.
Status ReadCsvPoint(const CsvReader& csv, const Trajectory& trajectory, bool first, TrajectoryPoint* point) {
  ALIDADE_RETURN_IF_ERROR(csv.ReadStamp(first, point->stamp_ns, &point->stamp_ns));
  ALIDADE_RETURN_IF_ERROR(ReadVector(csv, 1, "position", &point->nav.p_WB));
  if (trajectory.has_orientation) {
    ALIDADE_RETURN_IF_ERROR(ReadRotation(csv, 4, false, &point->nav.R_WB));
  }
  if (trajectory.has_velocity) {
    ALIDADE_RETURN_IF_ERROR(ReadVector(csv, 8, "velocity", &point->nav.v_WB));
    ALIDADE_RETURN_IF_ERROR(ReadVector(csv, 11, "gyro bias", &point->bias.gyro));
    ALIDADE_RETURN_IF_ERROR(ReadVector(csv, 14, "accel bias", &point->bias.accel));
  }
  if (trajectory.has_covariance) {
    ALIDADE_RETURN_IF_ERROR(ReadPoseCovariance(csv, kStateColumns, &point->covariance));
  }
  return Status::Ok();
}

/// Recognises the format by its header; sets the flags of `trajectory` and the number of columns.
Status RecognizeHeader(const CsvReader& csv, Trajectory* trajectory, size_t* columns) {
  *columns = csv.columns();
  const std::string_view first = csv.field(0);
  if (first == "timestamp_ns" || first == "#timestamp_ns") {
    trajectory->has_velocity = trajectory->has_bias = trajectory->has_covariance = true;
    return csv.ExpectHeader(StatesHeader(), true);  // clock terms may follow
  }
  if (*columns == kPositionColumns) {
    trajectory->has_orientation = false;
    return csv.ExpectHeader({PoseHeader().begin(), PoseHeader().begin() + kPositionColumns});
  }
  if (*columns == kPoseColumns) {
    return csv.field(1).starts_with("p_RS_R_x")
               ? csv.ExpectHeader({EurocHeader().begin(), EurocHeader().begin() + kPoseColumns})
               : csv.ExpectHeader(PoseHeader());
  }
  if (*columns == kStateColumns) {
    trajectory->has_velocity = trajectory->has_bias = true;
    return csv.ExpectHeader(EurocHeader());
  }
  return Status::Input(
      csv.Place() + ": found a first row of " + std::to_string(*columns) +
      " columns, expected the header of EuRoC truth (17 or 8 columns), positions (4) or states.csv (" +
      std::to_string(StatesHeader().size()) + " or more)");
}

Result<Trajectory> ReadCsvTrajectory(CsvReader& csv, const TakePoint& take) {
  Trajectory trajectory;
  size_t columns = 0;
  ALIDADE_RETURN_IF_ERROR(RecognizeHeader(csv, &trajectory, &columns));
  TrajectoryPoint point;
  for (bool first = true; csv.NextRow(); first = false) {
    ALIDADE_RETURN_IF_ERROR(csv.ExpectColumns(columns));
    ALIDADE_RETURN_IF_ERROR(ReadCsvPoint(csv, trajectory, first, &point));
    take(point);
  }
  return trajectory;
}

Status ReadTumPoint(const CsvReader& csv, TrajectoryPoint* point) {
  ALIDADE_RETURN_IF_ERROR(csv.ExpectColumns(kPoseColumns));
  if (!ParseDecimalSeconds(csv.field(0), &point->stamp_ns)) {
    return csv.Fault(0, "stamp", "decimal seconds below 9.2e9 (nanoseconds written as seconds?)");
  }
  ALIDADE_RETURN_IF_ERROR(ReadVector(csv, 1, "position", &point->nav.p_WB));
  return ReadRotation(csv, 4, true, &point->nav.R_WB);
}

Result<Trajectory> ReadTumTrajectory(const std::string& path) {
  Result<CsvReader> csv = CsvReader::Open(path, ' ');
  if (!csv.ok()) {
    return csv.status();
  }
  Trajectory trajectory;
  std::vector<TrajectoryPoint>& points = trajectory.points;
  // Some programs write time zero over and over until they are initialised: those rows are no poses.
  bool repeated_zero = false;
  while (csv->NextRow()) {
    if (csv->field(0).starts_with('#')) {
      continue;
    }
    TrajectoryPoint point;
    ALIDADE_RETURN_IF_ERROR(ReadTumPoint(*csv, &point));
    if (points.size() == 1 && points.front().stamp_ns == 0 && point.stamp_ns == 0) {
      repeated_zero = true;
      continue;
    }
    if (repeated_zero && points.size() == 1 && points.front().stamp_ns == 0) {
      points.clear();
    }
    if (!points.empty() && point.stamp_ns <= points.back().stamp_ns) {
      return csv->Fault(0, "stamp",
                        "a stamp later than " + FormatSeconds(points.back().stamp_ns) + " of the row before");
    }
    points.push_back(point);
  }
  return trajectory;
}

Status HoldsNone(const std::string& path) {
  return Status::Input(path + ": holds no pose, expected at least one row");
}

}  // namespace

Result<Trajectory> ReadTrajectory(const std::string& path, const TakePoint& take) {
  Result<CsvReader> csv = CsvReader::Open(path);
  if (!csv.ok()) {
    return csv.status();
  }
  csv->NextRow();
  bool some = false;
  const auto count = [&](const TrajectoryPoint& point) {
    some = true;
    take(point);
  };
  if (csv->columns() > 1) {
    Result<Trajectory> trajectory = ReadCsvTrajectory(*csv, count);
    return trajectory.ok() && !some ? HoldsNone(path) : trajectory;
  }
  Result<Trajectory> trajectory = ReadTumTrajectory(path);
  if (trajectory.ok()) {
    for (const TrajectoryPoint& point : trajectory->points) {
      count(point);
    }
    trajectory->points.clear();
  }
  return trajectory.ok() && !some ? HoldsNone(path) : trajectory;
}

Result<Trajectory> ReadTrajectory(const std::string& path) {
  std::vector<TrajectoryPoint> points;
  Result<Trajectory> trajectory =
      ReadTrajectory(path, [&points](const TrajectoryPoint& point) { points.push_back(point); });
  if (trajectory.ok()) {
    trajectory->points = std::move(points);
    if (!trajectory->has_covariance && trajectory->has_orientation) {
      ALIDADE_RETURN_IF_ERROR(ReadCovarianceBeside(path, &trajectory.value()));
    }
  }
  return trajectory;
}

}  // namespace alidade
