#include "eval/record/recorder_rows.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "eval/files/output_file.h"
#include "eval/record/recorder_gnss.h"
#include "eval/record/recorder_sensors.h"

namespace alidade {
namespace {

/// Appends ",x" for every coefficient.
void AppendNumbers(const Eigen::Ref<const Eigen::VectorXd>& values, char separator, std::string* line) {
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    *line += separator + ShortestDouble(values[i]);
  }
}

/// x y z w, w >= 0.
Eigen::Vector4d Quaternion(const Eigen::Matrix3d& rotation) {
  const Eigen::Quaterniond q(rotation);
  const Eigen::Vector4d xyzw = q.normalized().coeffs();
  return xyzw[3] < 0 ? Eigen::Vector4d(-xyzw) : xyzw;
}

void AppendUpperTriangle(const Matrix6d& covariance, std::string* line) {
  for (Eigen::Index row = 0; row < 6; ++row) {
    AppendNumbers(covariance.row(row).segment(row, 6 - row).transpose(), ',', line);
  }
}

/// ",c_00,c_01,...": names of the upper triangle that AppendUpperTriangle writes.
std::string TriangleNames() {
  std::string names;
  for (int row = 0; row < 6; ++row) {
    for (int column = row; column < 6; ++column) {
      names += ",c_" + std::to_string(row) + std::to_string(column);
    }
  }
  return names;
}

}  // namespace

std::string StatesHeader() {
  return "timestamp_ns,p_x,p_y,p_z,q_w,q_x,q_y,q_z,v_x,v_y,v_z,bg_x,bg_y,bg_z,ba_x,ba_y,ba_z" +
         TriangleNames() + "\n";
}

void AppendState(const RunRecord& record, bool with_clock, std::string* text) {
  const NavEstimate& estimate = record.estimate;
  const Eigen::Vector4d xyzw = Quaternion(estimate.nav.R_WB);
  *text += std::to_string(estimate.stamp_ns);
  AppendNumbers(estimate.nav.p_WB, ',', text);
  AppendNumbers(Eigen::Vector4d(xyzw[3], xyzw[0], xyzw[1], xyzw[2]), ',', text);
  AppendNumbers(estimate.nav.v_WB, ',', text);
  AppendNumbers(estimate.bias.gyro, ',', text);
  AppendNumbers(estimate.bias.accel, ',', text);
  AppendUpperTriangle(estimate.covariance.topLeftCorner<6, 6>(), text);
  *text += with_clock ? ClockFields(record) : "";
  *text += '\n';
}

std::string BoundHeader() {
  return "timestamp_ns" + TriangleNames() + "\n";
}

void AppendBound(const RunRecord& record, std::string* text) {
  *text += std::to_string(record.estimate.stamp_ns);
  AppendUpperTriangle(*record.filtering_covariance, text);
  *text += '\n';
}

std::string TimingHeader() {
  return "timestamp_ns,frontend_ms,propagate_ms,update_ms,backend_ms,total_ms\n";
}

void AppendTiming(const RunRecord& record, std::string* text) {
  Eigen::Matrix<double, 5, 1> row;
  row << record.frontend_ms, record.statistics.propagate_ms, record.statistics.update_ms, record.backend_ms,
      record.frontend_ms + record.backend_ms;
  *text += std::to_string(record.estimate.stamp_ns);
  AppendNumbers(row, ',', text);
  *text += '\n';
}

std::string StatusHeader(const EstimatorConfig& config) {
  return "timestamp_ns,status,tracks_in,features_used,features_gated,satellites_used,satellites_gated,"
         "nis,nis_dof,observations_invalid,features_waiting,features_degenerate,iterations,at_rest,reason,"
         "gnss_nis,gnss_nis_dof" +
         SensorColumns(config) + "\n";
}

void AppendStatus(const RunRecord& record, const EstimatorConfig& config, std::string* text) {
  const FrameStatistics& s = record.statistics;
  *text += std::to_string(record.estimate.stamp_ns) + "," + record.status;
  for (const int count :
       {s.tracks_in, s.features_used, s.features_gated, s.satellites_used, s.satellites_gated}) {
    *text += "," + std::to_string(count);
  }
  *text += "," + ShortestDouble(s.nis);
  for (const int count : {s.nis_dof, s.observations_invalid, s.features_waiting, s.features_degenerate,
                          s.iterations, s.at_rest ? 1 : 0}) {
    *text += "," + std::to_string(count);
  }
  std::string reason = record.reason;
  std::replace_if(
      reason.begin(), reason.end(), [](char c) { return c == ',' || c == '"' || c == '\n'; }, ';');
  *text += "," + reason + "," + ShortestDouble(s.gnss_nis) + "," + std::to_string(s.gnss_nis_dof);
  *text += SensorFields(config, s) + "\n";
}

void AppendCalibration(const RunRecord& record, std::string* text) {
  if (record.calibration) {  // else its row is in the spool
    *text += std::to_string(record.estimate.stamp_ns) + CalibrationFields(*record.calibration) + "\n";
  }
}

std::string ObservabilityHeader() {
  return "timestamp_ns,rank,yaw_leak,position_leak,yaw_gain,null_angle_rad\n";
}

void AppendObservability(const RunRecord& record, std::string* text) {
  if (record.observability) {
    const ObservabilityRecord& row = *record.observability;
    *text += std::to_string(row.stamp_ns) + "," + std::to_string(row.rank);
    AppendNumbers(Eigen::Vector4d(row.yaw_leak, row.position_leak, row.yaw_gain, row.null_angle_rad), ',',
                  text);
    *text += '\n';
  }
}

}  // namespace alidade
