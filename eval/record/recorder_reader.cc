#include "eval/record/recorder_reader.h"

#include <cmath>
#include <filesystem>
#include <tuple>

#include "eval/files/csv.h"
#include "eval/files/input_file.h"
#include "eval/record/recorder_covariance.h"
#include "eval/record/recorder_json.h"
#include "eval/record/recorder_sensors.h"
#include "eval/trajectory/trajectory_reader.h"

namespace alidade {
namespace {

using Json = nlohmann::ordered_json;

std::string In(const std::string& folder, const char* name) {
  return (std::filesystem::path(folder) / name).string();
}

Result<Json> ReadRunJson(const std::string& folder) {
  const std::string path = In(folder, "run.json");
  const Result<std::string> text = ReadWholeFile(path);
  if (!text.ok()) {
    return text.status();
  }
  Json json = Json::parse(*text, nullptr, false);
  if (!json.is_object()) {
    return Status::Input(path + ": is not a JSON object");
  }
  return json;
}

Status StatusFromWord(const std::string& word, const std::string& message) {
  if (word == "ok" || word == "interrupted") {
    return Status::Ok();
  }
  return word == "failed" ? Status::Input(message) : Status::Diverged(message);
}

Status ReadStates(const std::string& folder, RunResult* result) {
  const std::string path = In(folder, "states.csv");
  Result<Trajectory> trajectory = ReadTrajectory(path);
  if (!trajectory.ok()) {
    return trajectory.status();
  }
  result->records.resize(trajectory->points.size());
  for (size_t i = 0; i < result->records.size(); ++i) {
    const TrajectoryPoint& point = trajectory->points[i];
    NavEstimate& estimate = result->records[i].estimate;
    estimate.stamp_ns = point.stamp_ns;
    estimate.nav = point.nav;
    estimate.bias = point.bias;
    estimate.covariance.topLeftCorner<6, 6>() = point.covariance;
  }
  return Status::Ok();
}

/// Opens a table of `columns` columns, skips its header and hands every row to `read` with its record.
template <typename Read>
Status ReadRows(const std::string& path, size_t columns, RunResult* result, const Read& read) {
  Result<CsvReader> reader = CsvReader::Open(path);
  if (!reader.ok()) {
    return reader.status();
  }
  reader->NextRow();
  size_t row = 0;
  while (reader->NextRow()) {
    ALIDADE_RETURN_IF_ERROR(reader->ExpectColumns(columns));
    std::int64_t stamp = 0;
    ALIDADE_RETURN_IF_ERROR(reader->ReadInt64(0, "timestamp_ns", &stamp));
    if (row >= result->records.size() || result->records[row].estimate.stamp_ns != stamp) {
      return reader->Fault(0, "timestamp_ns", "the stamps of states.csv");
    }
    ALIDADE_RETURN_IF_ERROR(read(*reader, &result->records[row++]));
  }
  if (row != result->records.size()) {
    return Status::Input(path + ": found " + std::to_string(row) + " rows, expected " +
                         std::to_string(result->records.size()) + " as in states.csv");
  }
  return Status::Ok();
}

Status ReadTimingRow(const CsvReader& row, RunRecord* record) {
  ALIDADE_RETURN_IF_ERROR(row.ReadReal(1, "frontend_ms", &record->frontend_ms));
  ALIDADE_RETURN_IF_ERROR(row.ReadReal(2, "propagate_ms", &record->statistics.propagate_ms));
  ALIDADE_RETURN_IF_ERROR(row.ReadReal(3, "update_ms", &record->statistics.update_ms));
  return row.ReadReal(4, "backend_ms", &record->backend_ms);
}

Status ReadStatusRow(const CsvReader& row, RunRecord* record) {
  FrameStatistics& s = record->statistics;
  record->status = std::string(row.field(1));
  record->reason = std::string(row.field(14));
  const std::vector<std::pair<size_t, int*>> counts = {{2, &s.tracks_in},
                                                       {3, &s.features_used},
                                                       {4, &s.features_gated},
                                                       {5, &s.satellites_used},
                                                       {6, &s.satellites_gated},
                                                       {8, &s.nis_dof},
                                                       {9, &s.observations_invalid},
                                                       {10, &s.features_waiting},
                                                       {11, &s.features_degenerate},
                                                       {12, &s.iterations},
                                                       {16, &s.gnss_nis_dof}};
  for (const auto& [column, count] : counts) {
    std::int64_t value = 0;
    ALIDADE_RETURN_IF_ERROR(row.ReadInt64(column, "count", &value));
    *count = static_cast<int>(value);
  }
  std::int64_t at_rest = 0;
  ALIDADE_RETURN_IF_ERROR(row.ReadInt64(13, "at_rest", &at_rest));
  s.at_rest = at_rest != 0;
  ALIDADE_RETURN_IF_ERROR(row.ReadReal(7, "nis", &s.nis));
  return row.ReadReal(15, "gnss_nis", &s.gnss_nis);
}

/// status.csv; it has columns for each of SensorEntries that `json` has an object of.
Status ReadStatusTable(const std::string& folder, const Json& json, RunResult* result) {
  constexpr size_t kOwnColumns = 17;
  std::vector<Sensor> sensors;
  ForEachSensorEntry([&](auto entry, Sensor sensor) {
    if (json.contains(entry.kKey)) {
      sensors.push_back(sensor);
    }
  });
  return ReadRows(In(folder, "status.csv"), kOwnColumns + kColumnsPerSensor * sensors.size(), result,
                  [&](const CsvReader& row, RunRecord* record) {
                    ALIDADE_RETURN_IF_ERROR(ReadStatusRow(row, record));
                    return ReadSensorFields(row, kOwnColumns, sensors, &record->statistics);
                  });
}

Status ReadObservabilityRow(const CsvReader& row, RunRecord* record) {
  ObservabilityRecord& read = record->observability.emplace();
  read.stamp_ns = record->estimate.stamp_ns;
  std::int64_t rank = 0;
  ALIDADE_RETURN_IF_ERROR(row.ReadInt64(1, "rank", &rank));
  read.rank = static_cast<int>(rank);
  ALIDADE_RETURN_IF_ERROR(row.ReadReal(2, "yaw_leak", &read.yaw_leak));
  ALIDADE_RETURN_IF_ERROR(row.ReadReal(3, "position_leak", &read.position_leak));
  ALIDADE_RETURN_IF_ERROR(row.ReadReal(4, "yaw_gain", &read.yaw_gain));
  return row.ReadReal(5, "null_angle_rad", &read.null_angle_rad);
}

Status ReadBoundRow(const CsvReader& row, RunRecord* record) {
  Matrix6d covariance;
  size_t column = 1;
  for (Eigen::Index i = 0; i < 6; ++i) {
    for (Eigen::Index j = i; j < 6; ++j) {
      ALIDADE_RETURN_IF_ERROR(row.ReadReal(column++, "covariance", &covariance(i, j)));
      covariance(j, i) = covariance(i, j);
    }
  }
  record->filtering_covariance = covariance;
  return Status::Ok();
}

/// gnss.csv as WriteRun wrote it.
Status ReadSatellites(const std::string& path, RunResult* result) {
  constexpr double kDegree = M_PI / 180;
  Result<CsvReader> row = CsvReader::Open(path);
  ALIDADE_RETURN_IF_ERROR(row.status());
  row->NextRow();
  while (row->NextRow()) {
    ALIDADE_RETURN_IF_ERROR(row->ExpectColumns(9));
    std::int64_t stamp = 0;
    ALIDADE_RETURN_IF_ERROR(row->ReadInt64(0, "timestamp_ns", &stamp));
    const std::optional<SatelliteId> satellite = ParseSatellite(row->field(1));
    if (!satellite) {
      return row->Fault(1, "satellite", "such as G07");
    }
    SatelliteResidual s;
    s.satellite = *satellite;
    double azimuth = 0, elevation = 0, used = 0, rate_used = 0;
    const std::tuple<size_t, const char*, double*> values[] = {{2, "azimuth_deg", &azimuth},
                                                               {3, "elevation_deg", &elevation},
                                                               {4, "residual_m", &s.residual_m},
                                                               {5, "deviation_m", &s.deviation_m},
                                                               {6, "used", &used},
                                                               {8, "rate_used", &rate_used}};
    for (const auto& [column, name, value] : values) {
      ALIDADE_RETURN_IF_ERROR(row->ReadReal(column, name, value));
    }
    if (!row->field(7).empty()) {
      ALIDADE_RETURN_IF_ERROR(row->ReadReal(7, "rate_residual_mps", &s.range_rate_residual_mps.emplace()));
    }
    s.direction = {elevation * kDegree, azimuth * kDegree};
    s.used = used != 0;
    s.range_rate_used = rate_used != 0;
    if (result->gnss_residuals.empty() || result->gnss_residuals.back().stamp_ns != stamp) {
      result->gnss_residuals.push_back({stamp, {}});
    }
    result->gnss_residuals.back().satellites.push_back(s);
  }
  return Status::Ok();
}

/// What run.json holds.
RunResult ReadSummary(const Json& json) {
  RunResult result;
  const std::string word = JsonMember(json, "status", std::string("failed"));
  result.status = StatusFromWord(word, JsonMember(json, "message", std::string()));
  result.interrupted = word == "interrupted";
  const Json initialization = JsonMember(json, "initialization", Json::object());
  result.init_method = JsonMember(initialization, "method", std::string());
  result.init_report = JsonMember(initialization, "report", std::string());
  result.init_stamp_ns = JsonMember(initialization, "stamp_ns", TimeNs{0});
  result.skip_report = JsonMember(json, "skip_report", std::string());
  ForEachSensorEntry([&](auto entry, Sensor sensor) {
    result.skipped[sensor] = JsonMember(JsonMember(json, entry.kKey, Json::object()), "skipped", 0);
  });
  const Json counts = JsonMember(json, "counts", Json::object());
  result.frames_skipped = JsonMember(counts, "frames_skipped", 0);
  result.imu_rejected = JsonMember(counts, "imu_rejected", 0);
  result.global = ReadGlobalFrame(json);
  for (const Json& restart : JsonMember(json, "restarts", Json::array())) {
    result.restarts.push_back(
        {JsonMember(restart, "lost_ns", TimeNs{0}), JsonMember(restart, "reason", std::string()),
         JsonMember(restart, "restarted_ns", TimeNs{0}), JsonMember(restart, "report", std::string())});
  }
  if (const Json error = JsonMember(json, "calibration_error", Json()); error.is_object()) {
    result.calibration_error = {JsonMember(error, "rotation_rad", 0.0),
                                JsonMember(error, "translation_m", 0.0),
                                JsonMember(error, "time_offset_s", 0.0), JsonMember(error, "focal_px", 0.0)};
  }
  const Json times = JsonMember(json, "times", Json::object());
  result.wall_s = JsonMember(times, "wall_s", 0.0);
  result.cpu_s = JsonMember(times, "cpu_s", 0.0);
  return result;
}

/// The records and residuals; `json`: run.json.
Status ReadTables(const std::string& folder, const Json& json, RunResult* result) {
  ALIDADE_RETURN_IF_ERROR(ReadStates(folder, result));
  if (MayExist(In(folder, "covariance.csv"))) {
    ALIDADE_RETURN_IF_ERROR(
        ReadRows(In(folder, "covariance.csv"), kMotionCovarianceColumns, result, ReadMotionCovarianceRow));
  }
  ALIDADE_RETURN_IF_ERROR(ReadRows(In(folder, "timing.csv"), 6, result, ReadTimingRow));
  ALIDADE_RETURN_IF_ERROR(ReadStatusTable(folder, json, result));
  if (JsonMember(json, "audited", false)) {
    ALIDADE_RETURN_IF_ERROR(ReadRows(In(folder, "observability.csv"), 6, result, ReadObservabilityRow));
  }
  if (MayExist(In(folder, "gnss.csv"))) {
    ALIDADE_RETURN_IF_ERROR(ReadSatellites(In(folder, "gnss.csv"), result));
  }
  if (MayExist(In(folder, "bound.csv"))) {
    ALIDADE_RETURN_IF_ERROR(ReadRows(In(folder, "bound.csv"), 22, result, ReadBoundRow));
  }
  return Status::Ok();
}

}  // namespace

Result<RunResult> ReadRun(const std::string& folder) {
  const Result<Json> json = ReadRunJson(folder);
  if (!json.ok()) {
    return json.status();
  }
  RunResult result = ReadSummary(*json);
  // Without a frame the tables have a header alone.
  if (JsonMember(JsonMember(*json, "counts", Json::object()), "frames_processed", 0) != 0) {
    ALIDADE_RETURN_IF_ERROR(ReadTables(folder, *json, &result));
  }
  return result;
}

bool HoldsRun(const std::string& folder, const RunIdentity& identity) {
  const Result<Json> json = ReadRunJson(folder);
  const std::string word = json.ok() ? JsonMember(*json, "status", std::string("failed")) : "failed";
  return json.ok() && JsonMember(*json, "version", std::string()) == ALIDADE_VERSION &&
         JsonMember(*json, "config_digest", std::string()) == DigestOf(identity.config) &&
         JsonMember(*json, "input_digest", std::string()) == identity.input_digest &&
         JsonMember(*json, "dataset_digest", std::string()) == identity.dataset_digest &&
         JsonMember(*json, "seed", std::uint64_t{0}) == identity.seed &&
         JsonMember(*json, "truth_digest", std::string()) == identity.truth_digest &&
         JsonMember(*json, "audited", false) == identity.audited && word != "interrupted" && word != "failed";
}

}  // namespace alidade
