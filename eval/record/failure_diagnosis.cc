#include "eval/record/failure_diagnosis.h"

#include <algorithm>
#include <array>

#include "core/format.h"
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

/// The first seconds of a log, with the accelerometer's axes times `signs`.
MeasurementLog Beginning(const MeasurementLog& log, const Eigen::Vector3d& signs) {
  constexpr TimeNs kLengthNs = 25 * kSecondNs;
  MeasurementLog beginning;
  beginning.rig = log.rig;
  const TimeNs end_ns = log.frames.front().stamp_ns + kLengthNs;
  for (ImuSample sample : log.imu) {
    if (sample.stamp_ns <= end_ns + kSecondNs) {
      sample.accel = sample.accel.cwiseProduct(signs);
      beginning.imu.push_back(sample);
    }
  }
  for (const TrackFrame& frame : log.frames) {
    if (frame.stamp_ns <= end_ns) {
      beginning.frames.push_back(frame);
    }
  }
  return beginning;
}

/// Seconds in motion from a run's start to the first state that is lost or suspect. At rest wrong signs do
/// not show.
double SecondsSound(const RunResult& result) {
  double sound_s = 0;
  for (std::size_t i = 1; i < result.records.size() && result.records[i].status == "ok"; ++i) {
    const RunRecord& record = result.records[i];
    sound_s += record.statistics.at_rest
                   ? 0
                   : SecondsBetween(result.records[i - 1].estimate.stamp_ns, record.estimate.stamp_ns);
  }
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
                                                      const MeasurementLog& log, const RunResult& failed,
                                                      const RunOptions& options) {
  constexpr double kLeastS = 5;
  constexpr double kWaitS = 10;  // for a start
  if (log.frames.empty() || SecondsSound(failed) > kLeastS) {
    return std::nullopt;
  }
  EstimatorConfig filter = config;
  filter.backend = Backend::kFilter;
  filter.gnss.enabled = false;
  filter.fix.enabled = false;
  if (filter.init.method == InitMethod::kTruth) {
    filter.init.method = InitMethod::kAuto;
  }
  filter.recovery.enabled = false;  // a loss is an answer
  filter.init.max_wait_s = std::min(filter.init.max_wait_s, kWaitS);
  RunOptions quiet = options;
  quiet.progress = nullptr;
  quiet.audit = false;
  if (SecondsHeld(RunEstimator(filter, Beginning(log, Eigen::Vector3d::Ones()), quiet)) > kLeastS) {
    return std::nullopt;
  }
  for (const AccelerometerSigns& other : OtherSigns()) {
    const double held_s = SecondsHeld(RunEstimator(filter, Beginning(log, other.signs), quiet));
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
