#include "eval/record/failure_diagnosis.h"

#include <algorithm>
#include <vector>

#include "core/format.h"
#include "eval/dataset/log_tables.h"
#include "eval/record/accelerometer_signs.h"
#include "eval/record/runner.h"

namespace alidade {
namespace {

/// Those of stamps in [begin_ns, end_ns]; what cannot be read is missing.
template <typename Row>
std::vector<Row> RowsWithin(const Table<Row>& table, TimeNs begin_ns, TimeNs end_ns) {
  std::vector<Row> rows;
  typename Table<Row>::Pass pass(table);
  for (Result<const Row*> row = pass.Next(); row.ok() && *row != nullptr && (*row)->stamp_ns <= end_ns;
       row = pass.Next()) {
    if ((*row)->stamp_ns >= begin_ns) {
      rows.push_back(**row);
    }
  }
  return rows;
}

/// IMU time at which a run was lost, or of its first state that was not sound; empty: it never started.
std::optional<TimeNs> LostAt(const RunResult& failed) {
  if (!failed.restarts.empty()) {
    return failed.restarts.front().lost_ns;
  }
  std::optional<TimeNs> lost_ns;
  bool doubted = false;
  static_cast<void>(ForEachRecord(failed, [&](const RunRecord& record) {
    if (!doubted) {
      lost_ns = record.estimate.stamp_ns;
      doubted = record.status != "ok";
    }
    return Status::Ok();
  }));
  return lost_ns;
}

/// The measurements around a start that failed.
MeasurementLog SpanOfStart(const MeasurementLog& log, const LogTables& tables, const RunResult& failed) {
  constexpr TimeNs kLengthNs = 25 * kSecondNs;
  constexpr TimeNs kBeforeLossNs = 10 * kSecondNs;
  MeasurementLog span;
  span.rig = log.rig;
  const std::optional<TimeNs> lost_ns = LostAt(failed);
  const TimeNs first_ns = tables.frames.front().stamp_ns;
  const TimeNs offset_ns = SecondsToNs(log.rig.camera_time_offset_s);
  const TimeNs begin_ns = lost_ns ? std::max(first_ns, *lost_ns - offset_ns - kBeforeLossNs) : first_ns;
  span.imu =
      RowsWithin(tables.imu, begin_ns + offset_ns - kSecondNs, begin_ns + offset_ns + kLengthNs + kSecondNs);
  span.frames = RowsWithin(tables.frames, begin_ns, begin_ns + kLengthNs);
  return span;
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
  const auto stopped = [&options] { return options.stop != nullptr && options.stop->load(); };
  const MeasurementLog span = SpanOfStart(log, tables, failed);
  const auto with_signs = [&span](std::size_t choice) {
    return WithSigns(span, SignChoices()[choice].signs);
  };
  SignTrials trials;
  trials.stopped = stopped;
  trials.starts = [&](std::size_t choice) {
    if (options.progress) {
      options.progress(choice + 1, SignChoices().size());
    }
    return StartsInMotion(filter, with_signs(choice), options.stop);
  };
  trials.holds = [&](std::size_t choice) {
    const double held_s = SecondsHeld(RunEstimator(filter, with_signs(choice), quiet));
    return stopped() || held_s <= kLeastS ? std::nullopt : std::optional(held_s);
  };
  const std::optional<SignFinding> found = SearchSigns(trials);
  if (!found) {
    return std::nullopt;
  }
  return Format(
      "imu0: with %s negated a filter runs through %.0f s around the failed start without a fault: wrong "
      "sign of the specific force (at rest it points up)",
      SignChoices()[found->choice].name, found->held_s);
}

}  // namespace alidade
