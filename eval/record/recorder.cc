#include "eval/record/recorder.h"

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "eval/config/config_json.h"
#include "eval/config/config_writer.h"
#include "eval/files/hash.h"
#include "eval/files/output_file.h"
#include "eval/record/recorder_covariance.h"
#include "eval/record/recorder_gnss.h"
#include "eval/record/recorder_rows.h"
#include "eval/record/run_health.h"
#include "eval/run/make_estimator.h"
#include "eval/trajectory/trajectory_export.h"
#include "eval/trajectory/trajectory_point.h"

namespace alidade {
namespace {

using Json = nlohmann::ordered_json;

bool HasBound(const RunResult& result) {
  const RunRecord* first = FirstRecord(result);
  return first != nullptr && first->filtering_covariance.has_value();
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
  // The same records have just been written: they can be read.
  static_cast<void>(ForEachRecord(result, [&](const RunRecord& record) {
    used += record.statistics.sensors[sensor].used;
    gated += record.statistics.sensors[sensor].gated;
    return Status::Ok();
  }));
  Json json = {{"aligned", result.global.has_value()},
               {"report", result.align_report},
               {"used", used},
               {"gated", gated},
               {"skipped", result.skipped[sensor]}};
  if (result.global && result.global->source == sensor) {
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

Json RestartsJson(const std::vector<Restart>& restarts) {
  Json json = Json::array();
  for (const Restart& restart : restarts) {
    json.push_back({{"lost_ns", restart.lost_ns},
                    {"reason", restart.reason},
                    {"restarted_ns", restart.restarted_ns},
                    {"report", restart.init_report}});
  }
  return json;
}

Json CalibrationErrorJson(const CalibrationError& error, bool with_line_delay) {
  Json json = {{"rotation_rad", error.rotation_rad},
               {"translation_m", error.translation_m},
               {"time_offset_s", error.time_offset_s},
               {"focal_px", error.focal_px}};
  if (with_line_delay) {
    json["line_delay_s"] = error.line_delay_s;
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
  if (!identity.truth_digest.empty()) {
    json["truth_digest"] = identity.truth_digest;
  }
  json["initialization"] = {
      {"method", result.init_method}, {"report", result.init_report}, {"stamp_ns", result.init_stamp_ns}};
  json["counts"] = {{"imu_samples", identity.imu_samples},
                    {"imu_rejected", result.imu_rejected},
                    {"frames", identity.frames},
                    {"frames_processed", RecordCount(result)},
                    {"frames_skipped", result.frames_skipped}};
  json["skip_report"] = result.skip_report;
  const RunHealth health = HealthOf(identity.config, result);
  json["states"] = health.states;
  json["unsound_s"] = health.unsound_s;
  json["impaired"] = health.impairments;
  if (!result.restarts.empty()) {
    json["restarts"] = RestartsJson(result.restarts);
  }
  if (result.calibration_error) {
    json["calibration_error"] = CalibrationErrorJson(
        *result.calibration_error, result.records.back().calibration->layout.line_delay() >= 0);
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

/// One file of the run: a header, what the spool has of it, and a row a record.
struct RunTable {
  const char* name;
  bool has = true;
  std::string header;
  std::function<void(const RunRecord&, std::string*)> row;
  const SpoolFile* rows = nullptr;  ///< before those of the records
};

Status AppendSpool(const SpoolFile& rows, const AppendText& append) {
  constexpr size_t kBlock = size_t{1} << 18;
  std::string text;
  for (std::uint64_t at = 0; at < rows.size(); at += text.size()) {
    ALIDADE_RETURN_IF_ERROR(rows.Read(at, kBlock, &text));
    ALIDADE_RETURN_IF_ERROR(append(text));
  }
  return Status::Ok();
}

Status WriteRows(const RunTable& table, const RunResult& result, const AppendText& append) {
  constexpr size_t kBlock = size_t{1} << 16;
  std::string text = table.header;
  if (table.rows != nullptr) {
    ALIDADE_RETURN_IF_ERROR(append(std::exchange(text, {})));
    ALIDADE_RETURN_IF_ERROR(AppendSpool(*table.rows, append));
  }
  ALIDADE_RETURN_IF_ERROR(ForEachRecord(result, [&](const RunRecord& record) {
    table.row(record, &text);
    if (text.size() < kBlock) {
      return Status::Ok();
    }
    Status status = append(text);
    text.clear();
    return status;
  }));
  return append(text);
}

std::vector<RunTable> FilesOf(const RunIdentity& identity, const RunResult& result) {
  const RunRecord* first = FirstRecord(result);
  const bool gnss = HasGnss(result);
  // The records of a spool have no calibration.
  std::string calibration = result.spool == nullptr ? "" : result.spool->calibration_columns();
  if (calibration.empty() && first != nullptr && first->calibration) {
    calibration = CalibrationColumns(*first->calibration);
  }
  std::string states = StatesHeader();
  if (gnss) {
    states.insert(states.size() - 1, ClockColumns());
  }
  const SpoolFile* calibration_rows = result.spool == nullptr ? nullptr : &result.spool->calibration_rows();
  const SpoolFile* satellite_rows = result.spool == nullptr ? nullptr : &result.spool->satellite_rows();
  const auto nothing = [](const RunRecord&, std::string*) {};
  return {
      {"trajectory.tum", true, "",
       [](const RunRecord& r, std::string* t) { AppendTum(PointOf(r.estimate), t); }},
      {"states.csv", true, states, [gnss](const RunRecord& r, std::string* t) { AppendState(r, gnss, t); }},
      {"covariance.csv", true, MotionCovarianceHeader(), AppendMotionCovariance},
      {"timing.csv", true, TimingHeader(), AppendTiming},
      {"status.csv", true, StatusHeader(identity.config),
       [&identity](const RunRecord& r, std::string* t) { AppendStatus(r, identity.config, t); }},
      {"observability.csv", identity.audited, ObservabilityHeader(), AppendObservability},
      {"calibration.csv", !calibration.empty(), "timestamp_ns" + calibration + "\n", AppendCalibration,
       calibration_rows},
      {"bound.csv", HasBound(result), BoundHeader(), AppendBound},
      {"trajectory.pos", gnss, gnss ? AntennaHeader() : "",
       [&result](const RunRecord& r, std::string* t) { AppendAntenna(r, *result.global, t); }},
      {"gnss.csv", gnss, gnss ? SatelliteTable(result) : "", nothing, satellite_rows}};
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
  for (const RunTable& table : FilesOf(identity, result)) {
    if (table.has) {
      ALIDADE_RETURN_IF_ERROR(
          WriteFileAtomically((path / table.name).string(),
                              [&](const AppendText& append) { return WriteRows(table, result, append); }));
    } else {  // it must not stay from an earlier run
      std::filesystem::remove(path / table.name, ignored);
    }
  }
  const std::string json =
      RunJson(identity, result).dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
  return WriteFileAtomically((path / "run.json").string(), json);
}

}  // namespace alidade
