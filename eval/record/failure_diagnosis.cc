#include "eval/record/failure_diagnosis.h"

#include <algorithm>
#include <array>

#include "core/format.h"
#include "eval/dataset/log_tables.h"
#include "eval/record/runner.h"

namespace alidade {
namespace {

struct AccelerometerSigns {
  Eigen::Vector3d signs;
  const char* name;
};

/// The likeliest first.
const std::array<AccelerometerSigns, 7>& OtherSigns() {
  static const std::array<AccelerometerSigns, 7> signs = {
      {{{-1, -1, -1}, "all axes of the accelerometer"},
       {{1, 1, -1}, "the accelerometer's z axis"},
       {{1, -1, 1}, "the accelerometer's y axis"},
       {{-1, 1, 1}, "the accelerometer's x axis"},
       {{-1, -1, 1}, "the accelerometer's x and y axes"},
       {{-1, 1, -1}, "the accelerometer's x and z axes"},
       {{1, -1, -1}, "the accelerometer's y and z axes"}}};
  return signs;
}

/// Those up to a stamp; what cannot be read is missing.
template <typename Row>
std::vector<Row> RowsUntil(const Table<Row>& table, TimeNs end_ns) {
  std::vector<Row> rows;
  typename Table<Row>::Pass pass(table);
  for (Result<const Row*> row = pass.Next(); row.ok() && *row != nullptr && (*row)->stamp_ns <= end_ns;
       row = pass.Next()) {
    rows.push_back(**row);
  }
  return rows;
}

/// The first seconds of a log, with the accelerometer's axes times `signs`.
MeasurementLog Beginning(const MeasurementLog& log, const LogTables& tables, const Eigen::Vector3d& signs) {
  constexpr TimeNs kLengthNs = 25 * kSecondNs;
  MeasurementLog beginning;
  beginning.rig = log.rig;
  const TimeNs end_ns = tables.frames.front().stamp_ns + kLengthNs;
  beginning.imu = RowsUntil(tables.imu, end_ns + kSecondNs);
  for (ImuSample& sample : beginning.imu) {
    sample.accel = sample.accel.cwiseProduct(signs);
  }
  beginning.frames = RowsUntil(tables.frames, end_ns);
  return beginning;
}

/// Seconds in motion from a run's start to the first state that is lost or suspect. At rest wrong signs do
/// not show.
double SecondsSound(const RunResult& result) {
  double sound_s = 0;
  bool sound = true;
  TimeNs before_ns = INT64_MIN;
  static_cast<void>(ForEachRecord(result, [&](const RunRecord& record) {
    if (before_ns != INT64_MIN) {
      sound = sound && record.status == "ok";
      sound_s +=
          !sound || record.statistics.at_rest ? 0 : SecondsBetween(before_ns, record.estimate.stamp_ns);
    }
    before_ns = record.estimate.stamp_ns;
    return Status::Ok();
  }));
  return sound_s;
}

/// Seconds that a run got through from its start to the end of the log without being lost, and with less than
/// a tenth of its states suspect; 0 otherwise.
double SecondsHeld(const RunResult& result) {
  if (Failed(result) || result.records.empty()) {
    return 0;
  }
  std::size_t doubtful = 0;
  for (const RunRecord& record : result.records) {
    doubtful += record.status == "ok" ? 0 : 1;
  }
  const bool doubted = 10 * doubtful > result.records.size();
  return doubted ? 0
                 : SecondsBetween(result.records.front().estimate.stamp_ns,
                                  result.records.back().estimate.stamp_ns);
}

}  // namespace

bool Failed(const RunResult& result) {
  return !result.interrupted && (!result.status.ok() || !result.restarts.empty());
}

std::optional<std::string> DiagnoseAccelerometerSigns(const EstimatorConfig& config,
                                                      const MeasurementLog& log, const LogTables& tables,
                                                      const RunResult& failed, const RunOptions& options) {
  constexpr double kLeastS = 5;
  constexpr double kWaitS = 10;  // for a start
  if (tables.frames.empty() || SecondsSound(failed) > kLeastS) {
    return std::nullopt;
  }
  EstimatorConfig filter = config;
  filter.backend = Backend::kFilter;
  filter.gnss.enabled = false;
  ForEachSensorEntry([&](auto entry, Sensor) { entry.Config(filter).enabled = false; });
  if (filter.init.method == InitMethod::kTruth) {
    filter.init.method = InitMethod::kAuto;
  }
  filter.recovery.enabled = false;  // a loss is an answer
  filter.init.max_wait_s = std::min(filter.init.max_wait_s, kWaitS);
  RunOptions quiet = options;
  quiet.progress = nullptr;
  quiet.spool_folder.clear();
  quiet.audit = false;
  if (SecondsHeld(RunEstimator(filter, Beginning(log, tables, Eigen::Vector3d::Ones()), quiet)) > kLeastS) {
    return std::nullopt;
  }
  for (const AccelerometerSigns& other : OtherSigns()) {
    const double held_s = SecondsHeld(RunEstimator(filter, Beginning(log, tables, other.signs), quiet));
    if (held_s > kLeastS) {
      return Format(
          "imu0: with %s negated a filter runs through the first %.0f s without a fault: wrong sign of the "
          "specific force (at rest it points up)",
          other.name, held_s);
    }
  }
  return std::nullopt;
}

}  // namespace alidade
