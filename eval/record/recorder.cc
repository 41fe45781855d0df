#include "eval/record/recorder.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>

#include "eval/config/config_json.h"
#include "eval/config/config_writer.h"
#include "eval/files/csv_text.h"
#include "eval/files/hash.h"
#include "eval/files/output_file.h"
#include "eval/record/recorder_covariance.h"
#include "eval/record/recorder_gnss.h"
#include "eval/record/recorder_sensors.h"
#include "eval/run/make_estimator.h"
#include "eval/trajectory/trajectory_export.h"

namespace alidade {
namespace {

using Json = nlohmann::ordered_json;

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

void AppendUpperTriangle(const Matrix6d& covariance, std::string* line) {
  for (Eigen::Index row = 0; row < 6; ++row) {
    AppendNumbers(covariance.row(row).segment(row, 6 - row).transpose(), ',', line);
  }
}

std::string StatesHeader() {
  return "timestamp_ns,p_x,p_y,p_z,q_w,q_x,q_y,q_z,v_x,v_y,v_z,bg_x,bg_y,bg_z,ba_x,ba_y,ba_z" +
         TriangleNames() + "\n";
}

std::string StatesText(const RunResult& result) {
  std::string text = StatesHeader();
  if (HasGnss(result)) {
    text.insert(text.size() - 1, ClockColumns());
  }
  for (const RunRecord& record : result.records) {
    const NavEstimate& estimate = record.estimate;
    const Eigen::Vector4d xyzw = Quaternion(estimate.nav.R_WB);
    text += std::to_string(estimate.stamp_ns);
    AppendNumbers(estimate.nav.p_WB, ',', &text);
    AppendNumbers(Eigen::Vector4d(xyzw[3], xyzw[0], xyzw[1], xyzw[2]), ',', &text);
    AppendNumbers(estimate.nav.v_WB, ',', &text);
    AppendNumbers(estimate.bias.gyro, ',', &text);
    AppendNumbers(estimate.bias.accel, ',', &text);
    AppendUpperTriangle(estimate.covariance.topLeftCorner<6, 6>(), &text);
    text += HasGnss(result) ? ClockFields(record) : "";
    text += '\n';
  }
  return text;
}

bool HasBound(const RunResult& result) {
  return !result.records.empty() && result.records.front().filtering_covariance.has_value();
}

std::string BoundText(const RunResult& result) {
  std::string text = "timestamp_ns" + TriangleNames() + "\n";
  for (const RunRecord& record : result.records) {
    text += std::to_string(record.estimate.stamp_ns);
    AppendUpperTriangle(*record.filtering_covariance, &text);
    text += '\n';
  }
  return text;
}

std::string TimingText(const RunResult& result) {
  std::string text = "timestamp_ns,frontend_ms,propagate_ms,update_ms,backend_ms,total_ms\n";
  for (const RunRecord& record : result.records) {
    Eigen::Matrix<double, 5, 1> row;
    row << record.frontend_ms, record.statistics.propagate_ms, record.statistics.update_ms, record.backend_ms,
        record.frontend_ms + record.backend_ms;
    text += std::to_string(record.estimate.stamp_ns);
    AppendNumbers(row, ',', &text);
    text += '\n';
  }
  return text;
}

std::string StatusText(const RunResult& result, const EstimatorConfig& config) {
  std::string text =
      "timestamp_ns,status,tracks_in,features_used,features_gated,satellites_used,satellites_gated,nis,nis_"
      "dof,"
      "observations_invalid,features_waiting,features_degenerate,iterations,at_rest,reason,gnss_nis,gnss_nis_"
      "dof";
  text += SensorColumns(config) + "\n";
  for (const RunRecord& record : result.records) {
    const FrameStatistics& s = record.statistics;
    text += std::to_string(record.estimate.stamp_ns) + "," + record.status;
    for (const int count :
         {s.tracks_in, s.features_used, s.features_gated, s.satellites_used, s.satellites_gated}) {
      text += "," + std::to_string(count);
    }
    text += "," + ShortestDouble(s.nis);
    for (const int count : {s.nis_dof, s.observations_invalid, s.features_waiting, s.features_degenerate,
                            s.iterations, s.at_rest ? 1 : 0}) {
      text += "," + std::to_string(count);
    }
    std::string reason = record.reason;
    std::replace_if(
        reason.begin(), reason.end(), [](char c) { return c == ',' || c == '"' || c == '\n'; }, ';');
    text += "," + reason + "," + ShortestDouble(s.gnss_nis) + "," + std::to_string(s.gnss_nis_dof);
    text += SensorFields(config, s) + "\n";
  }
  return text;
}

std::string CalibrationText(const RunResult& result) {
  std::string text = "timestamp_ns" + CalibrationColumns(*result.records.front().calibration) + "\n";
  for (const RunRecord& record : result.records) {
    text += std::to_string(record.estimate.stamp_ns) + CalibrationFields(*record.calibration) + "\n";
  }
  return text;
}

std::string ObservabilityText(const RunResult& result) {
  std::string text = "timestamp_ns,rank,yaw_leak,position_leak,yaw_gain,null_angle_rad\n";
  for (const RunRecord& record : result.records) {
    if (record.observability) {
      const ObservabilityRecord& row = *record.observability;
      text += std::to_string(row.stamp_ns) + "," + std::to_string(row.rank);
      AppendNumbers(Eigen::Vector4d(row.yaw_leak, row.position_leak, row.yaw_gain, row.null_angle_rad), ',',
                    &text);
      text += '\n';
    }
  }
  return text;
}

/// How the run stood with GNSS.
Json GnssJson(const RunIdentity& identity, const RunResult& result) {
  Json json = Json::object();
  if (identity.config.gnss.enabled) {
    json = {{"aligned", HasGnss(result)},
            {"report", result.align_report},
            {"epochs_used", result.epochs_used},
            {"epochs_skipped", result.skipped[Sensor::kGnss]}};
  }
  if (HasGnss(result)) {
    const GlobalFrame& global = *result.global;
    const Eigen::Vector3d& anchor = global.enu->origin_E;
    json["aligned_ns"] = global.stamp_ns;
    json["anchor_E"] = {anchor.x(), anchor.y(), anchor.z()};
    json["lever_arm_m"] = {global.p_BA.x(), global.p_BA.y(), global.p_BA.z()};
    json["time_offset_s"] = global.time_offset_s;
    json["yaw_rad"] = global.yaw_rad;
    json["yaw_std_rad"] = global.yaw_std_rad;
  }
  return json;
}

/// How the run stood with one of SensorEntries.
Json SensorJson(const RunResult& result, Sensor sensor) {
  int used = 0;
  int gated = 0;
  for (const RunRecord& record : result.records) {
    used += record.statistics.sensors[sensor].used;
    gated += record.statistics.sensors[sensor].gated;
  }
  Json json = {{"aligned", result.global.has_value()},
               {"report", result.align_report},
               {"used", used},
               {"gated", gated},
               {"skipped", result.skipped[sensor]}};
  if (sensor == Sensor::kFix && result.global && result.global->source == GlobalFrame::Source::kFixes) {
    const GlobalFrame& global = *result.global;
    json["aligned_ns"] = global.stamp_ns;
    json["yaw_rad"] = global.yaw_rad;
    json["yaw_std_rad"] = global.yaw_std_rad;
    if (global.enu) {
      const Eigen::Vector3d& anchor = global.enu->origin_E;
      json["anchor_E"] = {anchor.x(), anchor.y(), anchor.z()};
    }
  }
  return json;
}

Json RunJson(const RunIdentity& identity, const RunResult& result) {
  EstimatorConfig config = identity.config;
  Json json;
  json["program"] = "alidade";
  json["version"] = ALIDADE_VERSION;
  json["status"] = StatusWord(result);
  json["message"] = result.status.message();
  json["estimator"] = config.name;
  json["backend"] = ToString(config.backend);
  json["dataset"] = identity.dataset;
  json["seed"] = identity.seed;
  json["config_digest"] = DigestOf(config);
  json["audited"] = identity.audited;
  json["dataset_digest"] = identity.dataset_digest;
  json["input_digest"] = identity.input_digest;
  json["initialization"] = {
      {"method", result.init_method}, {"report", result.init_report}, {"stamp_ns", result.init_stamp_ns}};
  json["counts"] = {{"imu_samples", identity.imu_samples},
                    {"imu_rejected", result.imu_rejected},
                    {"frames", identity.frames},
                    {"frames_processed", result.records.size()},
                    {"frames_skipped", result.frames_skipped}};
  json["skip_report"] = result.skip_report;
  if (!result.restarts.empty()) {
    json["restarts"] = Json::array();
    for (const Restart& restart : result.restarts) {
      json["restarts"].push_back({{"lost_ns", restart.lost_ns},
                                  {"reason", restart.reason},
                                  {"restarted_ns", restart.restarted_ns},
                                  {"report", restart.init_report}});
    }
  }
  if (result.calibration_error) {
    const CalibrationError& error = *result.calibration_error;
    json["calibration_error"] = {{"rotation_rad", error.rotation_rad},
                                 {"translation_m", error.translation_m},
                                 {"time_offset_s", error.time_offset_s},
                                 {"focal_px", error.focal_px}};
    if (result.records.back().calibration->layout.line_delay() >= 0) {
      json["calibration_error"]["line_delay_s"] = error.line_delay_s;
    }
  }
  if (identity.config.gnss.enabled || HasGnss(result)) {
    json["gnss"] = GnssJson(identity, result);
  }
  ForEachSensorEntry([&](auto entry, Sensor sensor) {
    if (entry.Config(config).enabled) {
      json[entry.kKey] = SensorJson(result, sensor);
    }
  });
  json["config"] = ConfigToJson([&config](ConfigVisitor& visitor) { config.Describe(visitor); });
  json["times"] = {{"wall_s", result.wall_s}, {"cpu_s", result.cpu_s}};
  return json;
}

}  // namespace

std::string DigestOf(const EstimatorConfig& config) {
  EstimatorConfig copy = config;  // Describe hands out pointers to what it lists
  return Sha256Hex(ConfigToYaml([&copy](ConfigVisitor& visitor) { copy.Describe(visitor); }, false));
}

Status WriteRun(const RunIdentity& identity, const RunResult& result, const std::string& folder) {
  const std::filesystem::path path(folder);
  std::error_code ignored;
  std::filesystem::remove(path / "run.json", ignored);
  // A file that this run does not have must not stay from an earlier one.
  const auto write = [&path](const char* name, bool has, const std::function<std::string()>& text) {
    if (has) {
      return WriteFileAtomically((path / name).string(), text());
    }
    std::error_code absent;
    std::filesystem::remove(path / name, absent);
    return Status::Ok();
  };
  const bool calibrates = !result.records.empty() && result.records.front().calibration;
  const bool gnss = HasGnss(result);
  ALIDADE_RETURN_IF_ERROR(write("trajectory.tum", true, [&] { return FormatTum(TrajectoryOf(result)); }));
  ALIDADE_RETURN_IF_ERROR(write("states.csv", true, [&] { return StatesText(result); }));
  ALIDADE_RETURN_IF_ERROR(write("covariance.csv", true, [&] { return MotionCovarianceText(result); }));
  ALIDADE_RETURN_IF_ERROR(write("timing.csv", true, [&] { return TimingText(result); }));
  ALIDADE_RETURN_IF_ERROR(write("status.csv", true, [&] { return StatusText(result, identity.config); }));
  ALIDADE_RETURN_IF_ERROR(
      write("observability.csv", identity.audited, [&] { return ObservabilityText(result); }));
  ALIDADE_RETURN_IF_ERROR(write("calibration.csv", calibrates, [&] { return CalibrationText(result); }));
  ALIDADE_RETURN_IF_ERROR(write("bound.csv", HasBound(result), [&] { return BoundText(result); }));
  ALIDADE_RETURN_IF_ERROR(
      write("trajectory.pos", gnss, [&] { return AntennaPositions(result, result.global->time_offset_s); }));
  ALIDADE_RETURN_IF_ERROR(write("gnss.csv", gnss, [&] { return SatelliteTable(result); }));
  const std::string json =
      RunJson(identity, result).dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
  return WriteFileAtomically((path / "run.json").string(), json);
}

}  // namespace alidade
