#include "eval/record/log_player.h"

#include <limits>
#include <memory>
#include <utility>

#include "core/check.h"
#include "core/cpu_time.h"
#include "core/stopwatch.h"
#include "eval/record/run_health.h"
#include "eval/record/truth_start.h"

namespace alidade {
namespace {

// Messages handed over ahead of a frame, beyond any receiver clock and any error of the camera's time offset.
constexpr TimeNs kEpochsAheadNs = 10'000'000'000;
constexpr TimeNs kImuAheadNs = kSecondNs;

}  // namespace

LogPlayer::LogPlayer(const EstimatorConfig& config, const MeasurementLog& log, const LogTables& tables,
                     const RunOptions& options, Estimator* estimator)
    : config_(config),
      log_(log),
      tables_(tables),
      options_(options),
      estimator_(*estimator),
      camera_(!tables.frames.empty() || log.gnss == nullptr || !config.gnss.enabled),
      session_(config, log.rig, OptionsOfSession(), estimator),
      builder_(camera_, options.spool_folder),
      result_(builder_.result()),
      imu_(tables.imu) {}

SessionOptions LogPlayer::OptionsOfSession() const {
  SessionOptions options;
  options.camera = camera_;
  // All of the log is at hand: a frame is processed when everything before it was handed over.
  options.live = !camera_;
  options.max_silence_s = std::numeric_limits<double>::infinity();
  options.max_waiting = std::numeric_limits<size_t>::max();
  options.start_state = [this](TimeNs imu_ns) { return FirstState(imu_ns); };
  if (log_.gnss != nullptr) {
    options.gnss = SetupOf(*log_.gnss);
  }
  return options;
}

RunResult LogPlayer::Play() {
  const Stopwatch wall;
  const double cpu_start = ThreadCpuSeconds();
  result_.imu_rejected = log_.imu_rejected;
  result_.missing_sensors = MissingSensors(config_, log_);
  if (!result_.missing_sensors.empty()) {
    result_.align_report = "the sequence has no " + result_.missing_sensors.front();
  }
  if (camera_) {
    PlayFrames();
  } else {
    PlayEpochs();
  }
  Conclude();
  CompareCalibration();
  result_.wall_s = wall.ElapsedS();
  result_.cpu_s = ThreadCpuSeconds() - cpu_start;
  return std::move(result_);
}

Status LogPlayer::CheckTruth() const {
  if (config_.init.method != InitMethod::kTruth || options_.start_state) {
    return Status::Ok();
  }
  if (options_.truth == nullptr) {
    return Status::Input(
        "init.method: found truth, but the sequence has no ground truth; expected static, "
        "dynamic or auto");
  }
  return CheckTruthForStart(*options_.truth);
}

Result<NavEstimate> LogPlayer::FirstState(TimeNs imu_ns) const {
  return options_.start_state ? options_.start_state(imu_ns)
                              : StartFromTruth(config_.init, *options_.truth, imu_ns, options_.seed);
}

void LogPlayer::PlayFrames() {
  Table<TrackFrame>::Pass frames(tables_.frames);
  for (size_t i = 0; i < tables_.frames.size() && result_.status.ok(); ++i) {
    const Result<const TrackFrame*> frame = frames.Next();
    if (!frame.ok()) {
      result_.status = frame.status();
      return;
    }
    if (!PlayFrame(**frame)) {
      return;
    }
    if (options_.progress) {
      options_.progress(i + 1, tables_.frames.size());
    }
  }
  if (result_.status.ok()) {
    session_.EndDoubt();
    AddImuUntil(last_frame_ns_ + kImuAheadNs);  // after a jump of its clock that the last frame revealed
    session_.AdvanceTo(last_frame_ns_);
    TakeEvents();
  }
}

bool LogPlayer::PlayFrame(const TrackFrame& frame) {
  if (Stopped()) {
    result_.interrupted = true;
    return false;
  }
  if (result_.status = CheckTruth(); !result_.status.ok()) {
    result_.init_report = result_.status.message();
    return false;
  }
  const TimeNs imu_ns = session_.ImuTime(frame.stamp_ns);
  AddImuUntil(imu_ns + kImuAheadNs);
  AddEpochsUntil(imu_ns + kEpochsAheadNs);
  AddMeasurementsUntil(imu_ns + kImuAheadNs);
  session_.AddFrame(frame);
  session_.AdvanceTo(imu_ns);
  last_frame_ns_ = imu_ns;
  TakeEvents();
  if (result_.status.ok() && !session_.running() && !builder_.lost() &&
      SecondsBetween(tables_.frames.front().stamp_ns, frame.stamp_ns) > config_.init.max_wait_s) {
    result_.status = Status::Diverged("not initialised within init.max_wait_s = " +
                                      std::to_string(config_.init.max_wait_s) + " s: " + result_.init_report);
  }
  return true;
}

void LogPlayer::PlayEpochs() {
  const size_t total = log_.gnss->epochs.size();
  while (next_epoch_ < total && result_.status.ok() && !result_.interrupted) {
    const TimeNs tag_ns = log_.gnss->epochs[next_epoch_].stamp_ns;
    AddEpoch(next_epoch_++);
    AddMeasurementsUntil(tag_ns + SecondsToNs(log_.rig.gnss.time_offset_s) + kImuAheadNs);
    AddImuUntil(tag_ns + SecondsToNs(log_.rig.gnss.time_offset_s));
    TakeEvents();
    if (options_.progress) {
      options_.progress(next_epoch_, total);
    }
    result_.interrupted = Stopped();
  }
  if (result_.status.ok() && !result_.interrupted) {
    AddMeasurementsUntil(std::numeric_limits<TimeNs>::max());
    AddImuUntil(std::numeric_limits<TimeNs>::max());
    session_.Flush();
    TakeEvents();
  }
}

void LogPlayer::AddImuUntil(TimeNs stamp_ns) {
  while (last_imu_ns_ < stamp_ns + session_.imu_jump_ns()) {
    const Result<const ImuSample*> sample = imu_.Next();
    if (!sample.ok() || *sample == nullptr) {
      result_.status = sample.ok() ? result_.status : sample.status();
      return;
    }
    last_imu_ns_ = (*sample)->stamp_ns;
    session_.AddImu(**sample);
  }
}

void LogPlayer::AddEpochsUntil(TimeNs imu_ns) {
  const TimeNs offset_ns = SecondsToNs(log_.rig.gnss.time_offset_s);
  while (config_.gnss.enabled && log_.gnss != nullptr && next_epoch_ < log_.gnss->epochs.size() &&
         log_.gnss->epochs[next_epoch_].stamp_ns + offset_ns < imu_ns) {
    AddEpoch(next_epoch_++);
  }
}

void LogPlayer::AddEpoch(size_t index) {
  session_.AddGnss(std::shared_ptr<const ObservationEpoch>(log_.gnss, &log_.gnss->epochs[index]));
}

void LogPlayer::AddMeasurementsUntil(TimeNs imu_ns) {
  ForEachSensorEntry([&](auto entry, Sensor sensor) {
    const auto& measurements = entry.Measurements(log_);
    for (size_t& next = next_measurement_[sensor];
         entry.Config(config_).enabled && next < measurements.size(); ++next) {
      const auto& measurement = measurements[next];
      const auto& sheet = entry.Sensors(log_.rig)[static_cast<size_t>(measurement.sensor)];
      if (measurement.stamp_ns + SecondsToNs(sheet.time_offset_s) >= imu_ns) {
        return;
      }
      session_.AddMeasurement(measurement);
    }
  });
}

void LogPlayer::TakeEvents() {
  for (const SessionEvent& event : session_.TakeEvents()) {
    builder_.Take(event);
  }
}

void LogPlayer::Conclude() {
  if (config_.init.method == InitMethod::kTruth && result_.init_method == "given" && !options_.start_state) {
    result_.init_method = "truth";
    result_.init_report =
        config_.init.perturb_truth
            ? "truth, moved by an error drawn from the prior with seed " + std::to_string(options_.seed)
            : "truth itself";
  }
  if (!result_.status.ok() || result_.interrupted) {
    return;
  }
  if (builder_.lost()) {
    result_.status = Status::Diverged(builder_.LostMessage());
  } else if (!session_.running()) {
    result_.status = Status::Diverged(
        "not initialised before the sequence ended: " +
        (result_.init_report.empty() ? std::string("there is no frame") : result_.init_report));
  } else {
    TakeFinalized();
  }
}

void LogPlayer::TakeFinalized() {
  const Stopwatch stopwatch;
  Result<std::vector<FinalizedFrame>> finalized = estimator_.TakeFinalized(options_.stop);
  result_.interrupted = Stopped();
  if (!finalized.ok()) {
    result_.status = finalized.status();
    return;
  }
  if (finalized->empty()) {
    return;
  }
  CHECK_EQ(finalized->size(), result_.records.size());
  const double share_ms = stopwatch.ElapsedMs() / static_cast<double>(finalized->size());
  for (size_t i = 0; i < finalized->size(); ++i) {
    FinalizedFrame& frame = (*finalized)[i];
    RunRecord& record = result_.records[i];
    record.estimate = std::move(frame.estimate);
    record.statistics = frame.statistics;
    record.backend_ms += share_ms;
    if (frame.filtering_covariance) {
      record.filtering_covariance = frame.filtering_covariance->topLeftCorner<6, 6>();
    }
  }
}

void LogPlayer::CompareCalibration() {
  if (options_.true_rig != nullptr && !result_.records.empty() && result_.records.back().calibration) {
    const RigCalibration& truth = *options_.true_rig;
    result_.calibration_error =
        CompareCalibrations(result_.records.back().calibration->mean,
                            {truth.camera, truth.T_BC, truth.camera_time_offset_s, truth.line_delay_s});
  }
}

}  // namespace alidade
