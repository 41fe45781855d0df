#include "eval/run/estimator_loop.h"

#include <algorithm>
#include <utility>

#include "core/calibration.h"
#include "core/format.h"

namespace alidade {
EstimatorLoop::EstimatorLoop(const EstimatorConfig& config, const RigCalibration& rig,
                             const SessionOptions& options, Estimator* estimator,
                             std::vector<SessionEvent>* events)
    : config_(config),
      rig_(rig),
      options_(options),
      read_out_span_ns_(SecondsToNs(ReadOutSpan(GivenCamera(rig, config.vision)))),
      estimator_(*estimator),
      events_(*events),
      implied_(config.imu.gravity_mps2),
      imu_(config.imu.guard, &implied_),
      recovery_(config, rig, options.camera),
      sensors_(config, rig, options, estimator, events) {
  if (options.camera && config.init.method != InitMethod::kTruth) {
    initializer_ = std::make_unique<Initializer>(config, rig);
  }
}

TimeNs EstimatorLoop::ImuTime(TimeNs camera_ns) const {
  const std::optional<CalibrationEstimate> calibration =
      running() ? estimator_.LatestCalibration() : std::nullopt;
  return camera_ns + SecondsToNs(calibration ? calibration->mean.time_offset_s : rig_.camera_time_offset_s);
}

TimeNs EstimatorLoop::EpochLead() const {
  return options_.camera || running() ? 0 : SecondsToNs(config_.gnss.max_time_offset_s);
}

void EstimatorLoop::ProcessFrame(const TrackFrame& frame) {
  const Stopwatch stopwatch;
  const TimeNs imu_ns = ImuTime(frame.stamp_ns);
  DeliverImu(imu_ns + FrameLead());
  if (degradation_.IsFrozen(frame)) {
    ProcessTracks({frame.stamp_ns, {}, frame.frontend_ms, degradation_.TracksGoOn(imu_ns)}, stopwatch);
  } else {
    ProcessTracks(frame, stopwatch);
  }
  if (running()) {
    AlignAfterFrame(imu_ns);
  }
  TrimImu();
}

void EstimatorLoop::ProcessTracks(const TrackFrame& frame, const Stopwatch& stopwatch) {
  if (phase_ == Phase::kSeeking) {
    TryStart(frame);
  } else if (phase_ == Phase::kLost) {
    TryRestart(frame);
  }
  if (running()) {
    AddFrame(frame, stopwatch);
  }
}

void EstimatorLoop::ProcessEpoch() {
  if (options_.camera) {
    ProcessMessage(gnss());
  } else {
    ProcessEpochAlone();
    TrimImu();
  }
}

void EstimatorLoop::ProcessEpochAlone() {
  const Stopwatch stopwatch;
  const TimeNs stamp_ns = gnss()->feed().Next()->stamp_ns;
  DeliverImu(stamp_ns + EpochLead());
  if (!running()) {
    StartWithEpoch();
    return;
  }
  const Result<bool> taken = gnss()->Take(true);
  if (!taken.ok()) {
    Fail(stamp_ns, taken.status());
  } else if (*taken) {
    ReportState(Sensor::kGnss, stamp_ns, 0, stopwatch);
    WatchSensor(*gnss());
    if (const std::string reason = degradation_.AgainstSensors("the IMU"); !reason.empty() && running()) {
      events_.emplace_back(DegradedEvent{state_ns_, reason, DegradationKind::kData});
    }
  }
}

void EstimatorLoop::ProcessMessage(SensorRun* sensor) {
  const Stopwatch stopwatch;
  const TimeNs stamp_ns = *sensor->NextImuTime();
  if (sensor->aligned()) {
    DeliverImu(stamp_ns);
  }
  const Result<bool> taken = sensor->Take(running());
  if (taken.code() == StatusCode::kDiverged) {
    GiveUp(estimator_.Latest().stamp_ns, taken.status());
  } else if (!taken.ok()) {
    Fail(stamp_ns, taken.status());
  } else if (*taken) {
    ReportState(sensor->sensor(), stamp_ns, 0, stopwatch);
    WatchSensor(*sensor);
  }
  TrimImu();
}

void EstimatorLoop::DeliverImu(TimeNs stamp_ns) {
  while (const ImuSample* sample = imu_.Deliver(stamp_ns)) {
    gyro_radps_ = sample->gyro;
    degradation_.OnImu(sample->stamp_ns, imu_.guard().doubt(), imu_.guard().unit_changed_ns());
    if (!imu_.fault().empty()) {
      events_.emplace_back(SkippedEvent{Sensor::kImu, sample->stamp_ns, imu_.fault()});
    }
    if (running()) {
      AddImu(*sample);
    } else if (phase_ == Phase::kLost) {
      recovery_.AddImu(*sample);
    } else if (initializer_ != nullptr) {
      initializer_->AddImu(*sample);
    } else if (gnss() != nullptr && !options_.camera) {
      gnss()->AddImuBeforeStart(*sample);
    }
  }
}

void EstimatorLoop::AddImu(const ImuSample& sample) {
  recovery_.AddImu(sample);
  if (const Status status = estimator_.AddImu(sample); !status.ok()) {
    events_.emplace_back(SkippedEvent{Sensor::kImu, sample.stamp_ns, status.message()});
  }
}

void EstimatorLoop::AddFrame(const TrackFrame& frame, const Stopwatch& stopwatch) {
  Status status = estimator_.AddFrame(frame);
  if (status.code() == StatusCode::kInput) {
    events_.emplace_back(SkippedEvent{Sensor::kCamera, frame.stamp_ns, status.message()});
    return;
  }
  if (status.ok()) {
    const std::string reason = recovery_.Check(estimator_.Latest(), estimator_.last_statistics());
    status = reason.empty()
                 ? Status::Ok()
                 : Status::Diverged(reason + " after the frame at " + FormatSeconds(frame.stamp_ns) + " s");
  }
  if (!status.ok()) {
    GiveUp(ImuTime(frame.stamp_ns), status);
    return;
  }
  ReportState(Sensor::kCamera, frame.stamp_ns, frame.frontend_ms, stopwatch);
  if (running()) {
    ReportDegraded(ImuTime(frame.stamp_ns));
  }
}

void EstimatorLoop::ReportDegraded(TimeNs imu_ns) {
  const std::optional<CalibrationEstimate> camera = estimator_.LatestCalibration();
  std::optional<CalibrationDoubt> doubt;
  if (camera && camera->watched) {
    doubt = FindCalibrationDoubt(*camera, estimator_.Latest().covariance);
  }
  Degradation::Verdict verdict =
      degradation_.Check(imu_ns, estimator_.last_statistics(), doubt ? &*doubt : nullptr);
  if (!verdict.reason.empty()) {
    events_.emplace_back(DegradedEvent{state_ns_, std::move(verdict.reason), verdict.kind});
  }
}

void EstimatorLoop::AlignAfterFrame(TimeNs stamp_ns) {
  const Result<std::optional<GnssAlignment>> alignment = sensors_.Align(stamp_ns, gyro_radps_);
  if (!alignment.ok()) {
    Fail(stamp_ns, alignment.status());
  } else if (*alignment) {
    implied_.Forget();
    recovery_.Turn(**alignment);
  }
}

void EstimatorLoop::ReportState(Sensor source, TimeNs message_ns, double frontend_ms,
                                const Stopwatch& stopwatch) {
  const bool is_frame = source == Sensor::kCamera;
  StateEvent event;
  event.source = source;
  event.message_ns = message_ns;
  event.estimate = estimator_.Latest();
  if (!IsFinite(event.estimate)) {
    GiveUp(is_frame ? ImuTime(message_ns) : message_ns,
           Status::Diverged("state is not finite after the frame at " + FormatSeconds(message_ns) + " s"));
    return;
  }
  state_ns_ = event.estimate.stamp_ns;
  if (is_frame || !options_.camera) {
    implied_.Add(event.estimate);
  }
  event.statistics = is_frame ? estimator_.last_statistics() : BetweenFrames(estimator_.last_statistics());
  event.clock = estimator_.LatestClock();
  event.calibration = estimator_.LatestCalibration();
  if (event.calibration && event.calibration->watched) {
    event.calibration.reset();  // it is as given
  }
  event.frontend_ms = frontend_ms;
  event.backend_ms = stopwatch.ElapsedMs();
  const bool suspect = event.statistics.suspect;
  if (gnss() != nullptr && is_frame) {
    gnss()->CollectResiduals();  // the smoother gates an epoch with the frame after it
    gnss()->Remember(state_ns_, event.clock);
  }
  events_.emplace_back(std::move(event));
  if (suspect) {
    events_.emplace_back(SuspectEvent{state_ns_, "most tracks contradict the state"});
  }
}

void EstimatorLoop::GiveUp(TimeNs stamp_ns, const Status& status) {
  if (recovery_.GiveUp(stamp_ns)) {
    phase_ = Phase::kLost;
    events_.emplace_back(LostEvent{stamp_ns, status.message()});
  } else {
    Fail(stamp_ns, status);
  }
}

void EstimatorLoop::Fail(TimeNs stamp_ns, Status status) {
  phase_ = Phase::kFailed;
  events_.emplace_back(FailedEvent{stamp_ns, std::move(status)});
}

void EstimatorLoop::PassTime(TimeNs now_ns) {
  if (running()) {
    if (SecondsBetween(state_ns_, now_ns) > options_.max_silence_s) {
      GiveUp(state_ns_ + SecondsToNs(options_.max_silence_s),
             Status::Diverged(Format("no frame or measurement was used for %g s", options_.max_silence_s)));
    }
    return;
  }
  // No start looks back that far.
  constexpr double kForeverS = 1e9;
  const TimeNs oldest_ns = now_ns - SecondsToNs(std::min(options_.max_silence_s, kForeverS));
  while (const std::optional<ImuSample> sample = imu_.PassOver(oldest_ns)) {
    if (phase_ == Phase::kLost) {
      recovery_.PassOver(*sample);
    }
  }
}

void EstimatorLoop::TrimImu() {
  // A state found by an epoch alone may lie before what was delivered by twice the unknown time offset.
  constexpr double kMarginS = 1;
  if (imu_.delivered_ns() != INT64_MIN) {
    const TimeNs newest = imu_.delivered_ns() - SecondsToNs(kMarginS + 2 * config_.gnss.max_time_offset_s);
    imu_.DropBefore(running() ? std::min(newest, state_ns_) : newest);
  }
}

}  // namespace alidade
