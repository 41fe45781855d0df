#include "eval/run/estimator_run.h"

#include <time.h>

#include <utility>

#include "core/check.h"

namespace alidade {
namespace {

double ThreadCpuSeconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + static_cast<double>(now.tv_nsec) * kNsToSeconds;
}

}  // namespace

EstimatorRun::EstimatorRun(const EstimatorConfig& config, const MeasurementLog& log,
                           const RunOptions& options, Estimator* estimator)
    : config_(config),
      log_(log),
      options_(options),
      estimator_(*estimator),
      start_(config, log, options, &result_),
      recovery_(config, log, &result_) {
  if (config.gnss.enabled && log.gnss != nullptr) {
    gnss_.emplace(config, log, estimator, &result_);
  }
}

RunResult EstimatorRun::Execute() {
  const Stopwatch wall;
  const double cpu_start = ThreadCpuSeconds();
  if (config_.gnss.enabled && log_.gnss == nullptr) {
    result_.align_report = "the sequence has no GNSS";
  }
  for (size_t i = 0; i < log_.frames.size() && result_.status.ok(); ++i) {
    if (options_.stop != nullptr && options_.stop->load()) {
      result_.interrupted = true;
      break;
    }
    ProcessEpochsBefore(ImuStamp(log_.frames[i]));
    if (result_.status.ok()) {
      ProcessFrame(log_.frames[i]);
    }
    if (options_.progress) {
      options_.progress(i + 1, log_.frames.size());
    }
  }
  if (gnss_ && log_.frames.empty()) {
    ProcessEpochsAlone();
  }
  if (result_.status.ok() && recovery_.lost() && !result_.interrupted) {
    result_.status = Status::Diverged(recovery_.Message());
  }
  if (result_.status.ok() && !initialized_ && !result_.interrupted) {
    result_.status = Status::Diverged("not initialised before the sequence ended: " + Reason());
  }
  if (result_.status.ok() && !result_.interrupted) {
    Finalize();
  }
  CompareCalibration();
  result_.wall_s = wall.ElapsedS();
  result_.cpu_s = ThreadCpuSeconds() - cpu_start;
  return std::move(result_);
}

TimeNs EstimatorRun::ImuStamp(const TrackFrame& frame) const {
  const std::optional<CalibrationEstimate> calibration =
      initialized_ ? estimator_.LatestCalibration() : std::nullopt;
  return frame.stamp_ns +
         SecondsToNs(calibration ? calibration->mean.time_offset_s : log_.rig.camera_time_offset_s);
}

void EstimatorRun::ProcessFrame(const TrackFrame& frame) {
  const Stopwatch stopwatch;
  const TimeNs imu_stamp_ns = ImuStamp(frame);
  DeliverImu(imu_stamp_ns);
  if (!initialized_) {
    TryInitialize(frame);
  }
  if (initialized_) {
    AddFrame(frame, stopwatch);
    if (gnss_ && result_.status.ok() && initialized_) {
      gnss_->Align(imu_stamp_ns, log_.imu[next_imu_ - 1].gyro);
    }
  } else if (result_.status.ok() && !recovery_.lost() &&
             SecondsBetween(log_.frames.front().stamp_ns, frame.stamp_ns) > config_.init.max_wait_s) {
    result_.status = Status::Diverged("not initialised within init.max_wait_s = " +
                                      std::to_string(config_.init.max_wait_s) + " s: " + Reason());
  }
}

void EstimatorRun::ProcessEpochsBefore(TimeNs stamp_ns) {
  while (gnss_ && result_.status.ok()) {
    const GnssEpoch* epoch = gnss_->NextEpoch();
    if (epoch == nullptr || epoch->stamp_ns >= stamp_ns) {
      return;
    }
    if (result_.global) {
      DeliverImu(epoch->stamp_ns);
    }
    gnss_->TakeEpoch();
    if (result_.status.code() == StatusCode::kDiverged) {
      GiveUp(estimator_.Latest().stamp_ns, std::exchange(result_.status, Status::Ok()));
    }
  }
}

void EstimatorRun::ProcessEpochsAlone() {
  const size_t total = log_.gnss->epochs.size();
  for (size_t done = 1; result_.status.ok() && !result_.interrupted; ++done) {
    const GnssEpoch* epoch = gnss_->NextEpoch();
    if (epoch == nullptr) {
      return;
    }
    const Stopwatch stopwatch;
    const TimeNs stamp_ns = epoch->stamp_ns;
    DeliverImu(stamp_ns + SecondsToNs(initialized_ ? 0 : config_.gnss.max_time_offset_s));
    if (!initialized_) {
      StartWithEpoch();
    } else {
      gnss_->TakeEpoch();
      if (result_.status.ok()) {
        RecordState(stamp_ns, stopwatch);
      }
    }
    if (options_.progress) {
      options_.progress(done, total);
    }
    result_.interrupted = options_.stop != nullptr && options_.stop->load();
  }
}

void EstimatorRun::StartWithEpoch() {
  const std::optional<GnssInertialStart::Start> start = gnss_->TryStart();
  if (!start) {
    return;
  }
  result_.init_stamp_ns = start->estimate.stamp_ns;
  Begin(start->estimate);
  if (initialized_) {
    gnss_->AlignAtStart(*start);
  }
}

void EstimatorRun::DeliverImu(TimeNs stamp_ns) {
  while (next_imu_ < log_.imu.size() && (next_imu_ == 0 || log_.imu[next_imu_ - 1].stamp_ns < stamp_ns)) {
    const ImuSample& sample = log_.imu[next_imu_++];
    if (initialized_) {
      AddImu(sample);
    } else if (recovery_.lost()) {
      recovery_.AddImu(sample);
    } else {
      start_.AddImu(sample);
      if (gnss_ && log_.frames.empty()) {
        gnss_->AddImuBeforeStart(sample);
      }
    }
  }
}

void EstimatorRun::AddImu(const ImuSample& sample) {
  result_.imu_rejected += estimator_.AddImu(sample).ok() ? 0 : 1;
}

void EstimatorRun::TryInitialize(const TrackFrame& frame) {
  if (recovery_.lost()) {
    TryRestart(frame);
    return;
  }
  const Result<NavEstimate> start = start_.TryFrame(frame, ImuStamp(frame));
  if (!start.ok()) {
    result_.init_report = start.message();
    return;
  }
  result_.init_stamp_ns = start->stamp_ns;
  Begin(*start);
}

void EstimatorRun::TryRestart(const TrackFrame& frame) {
  const Result<NavEstimate> start = recovery_.TryStart(frame, next_imu_);
  if (!start.ok()) {
    return;
  }
  Begin(*start);
  if (initialized_) {
    recovery_.Started(*start);
    restarted_ = true;
    if (gnss_) {
      gnss_->Realign();
    }
  }
}

void EstimatorRun::GiveUp(TimeNs stamp_ns, Status status) {
  if (recovery_.GiveUp(stamp_ns, status.message())) {
    initialized_ = false;
  } else {
    result_.status = std::move(status);
  }
}

void EstimatorRun::Begin(const NavEstimate& start) {
  if (const Status status = estimator_.Initialize(start); !status.ok()) {
    result_.status = Status::Diverged("initial state refused: " + status.message());
    return;
  }
  initialized_ = true;
  // The estimator starts at the initial stamp: it needs the delivered samples from the last one not after
  // it on.
  size_t first = next_imu_;
  while (first > 0 && (first == next_imu_ || log_.imu[first].stamp_ns > start.stamp_ns)) {
    --first;
  }
  for (size_t i = first; i < next_imu_; ++i) {
    AddImu(log_.imu[i]);
  }
}

void EstimatorRun::AddFrame(const TrackFrame& frame, const Stopwatch& stopwatch) {
  Status status = estimator_.AddFrame(frame);
  if (status.code() == StatusCode::kInput) {
    result_.skip_report = result_.frames_skipped++ == 0 ? status.message() : result_.skip_report;
    return;
  }
  if (status.ok()) {
    const std::string reason = recovery_.Check(estimator_.Latest(), estimator_.last_statistics());
    status = reason.empty()
                 ? Status::Ok()
                 : Status::Diverged(reason + " after the frame at " + FormatSeconds(frame.stamp_ns) + " s");
  }
  if (!status.ok()) {
    GiveUp(ImuStamp(frame), std::move(status));
    return;
  }
  const size_t before = result_.records.size();
  RecordState(frame.stamp_ns, stopwatch);
  if (result_.status.ok() && result_.records.size() > before) {
    RunRecord& record = result_.records.back();
    record.frontend_ms = frame.frontend_ms;
    if (restarted_ || record.statistics.suspect) {
      record.status = restarted_ ? "restarted" : "suspect";
      record.reason = restarted_ ? result_.restarts.back().init_report : "most tracks contradict the state";
    }
    restarted_ = false;
  }
}

void EstimatorRun::RecordState(TimeNs stamp_ns, const Stopwatch& stopwatch) {
  RunRecord record;
  record.estimate = estimator_.Latest();
  if (!IsFinite(record.estimate)) {
    result_.status =
        Status::Diverged("state is not finite after the frame at " + FormatSeconds(stamp_ns) + " s");
    return;
  }
  if (!result_.records.empty() && record.estimate.stamp_ns <= result_.records.back().estimate.stamp_ns) {
    return;  // an epoch that was left out
  }
  record.statistics = log_.frames.empty() ? FrameStatistics() : estimator_.last_statistics();
  if (gnss_) {
    gnss_->Tell(&record.statistics);
  }
  record.clock = estimator_.LatestClock();
  record.calibration = estimator_.LatestCalibration();
  record.backend_ms = stopwatch.ElapsedMs();
  result_.records.push_back(std::move(record));
}

void EstimatorRun::Finalize() {
  const Stopwatch stopwatch;
  Result<std::vector<FinalizedFrame>> finalized = estimator_.TakeFinalized(options_.stop);
  result_.interrupted = options_.stop != nullptr && options_.stop->load();
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

void EstimatorRun::CompareCalibration() {
  if (options_.true_rig != nullptr && !result_.records.empty() && result_.records.back().calibration) {
    const RigCalibration& truth = *options_.true_rig;
    result_.calibration_error = CompareCalibrations(result_.records.back().calibration->mean,
                                                    {truth.camera, truth.T_BC, truth.camera_time_offset_s});
  }
}

std::string EstimatorRun::Reason() const {
  return result_.init_report.empty() ? "there is no frame" : result_.init_report;
}

}  // namespace alidade
