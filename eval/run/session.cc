#include "eval/run/session.h"

#include <algorithm>
#include <utility>

#include "core/format.h"
#include "eval/run/dead_reckoning.h"
#include "eval/run/make_estimator.h"

namespace alidade {

Result<std::unique_ptr<Session>> Session::Make(const EstimatorConfig& config, const RigCalibration& rig,
                                               SessionOptions options) {
  ALIDADE_RETURN_IF_ERROR(config.Validate());
  ALIDADE_RETURN_IF_ERROR(options.Validate(config));
  std::unique_ptr<Estimator> estimator = MakeEstimator(config, rig);
  auto session = std::make_unique<Session>(config, rig, std::move(options), estimator.get());
  session->own_estimator_ = std::move(estimator);
  return session;
}

Session::Session(const EstimatorConfig& config, const RigCalibration& rig, SessionOptions options,
                 Estimator* estimator)
    : config_(config),
      rig_(rig),
      options_(std::move(options)),
      loop_(config_, rig_, options_, estimator, &events_),
      camera_clock_(rig_, config_.vision.pixel_noise_px),
      frame_offset_ns_(loop_.ImuTime(0)) {}

void Session::AddImu(const ImuSample& sample) {
  if (failed()) {
    return;
  }
  if (!sample.gyro.allFinite() || !sample.accel.allFinite()) {
    Skip(Sensor::kImu, sample.stamp_ns, "not finite");
    return;
  }
  if (options_.live) {
    TakeUnlessLeap(sample);
  } else {
    TakeImu(sample);
  }
}

void Session::TakeUnlessLeap(const ImuSample& sample) {
  const TimeNs newest_ns = loop_.imu().newest_ns();
  const ImuLeap::Outcome outcome = leap_.Add(sample, newest_ns);
  if (outcome.refused) {
    const TimeNs refused_ns = outcome.refused->stamp_ns;
    Skip(Sensor::kImu, refused_ns,
         Format("its stamp is %.3f s after the previous sample and no later sample confirms it",
                SecondsBetween(newest_ns, refused_ns)));
  }
  if (outcome.confirmed) {
    TakeImu(*outcome.confirmed);
  }
  if (outcome.verdict == ImuLeap::Verdict::kTake) {
    TakeImu(sample);
  } else if (outcome.verdict == ImuLeap::Verdict::kTwice) {
    SkipTwice(Sensor::kImu, sample.stamp_ns);
  }
}

void Session::TakeImu(const ImuSample& sample) {
  switch (loop_.imu().Add(sample)) {
    case ImuStream::Arrival::kTwice:
      SkipTwice(Sensor::kImu, sample.stamp_ns);
      return;
    case ImuStream::Arrival::kTooLate:
      RefuseLate(Sensor::kImu, sample.stamp_ns, loop_.imu().delivered_ns() - sample.stamp_ns);
      return;
    case ImuStream::Arrival::kTaken:
      break;
  }
  camera_clock_.AddImu(sample);
  Process();
}

void Session::AddFrame(TrackFrame frame) {
  if (failed()) {
    return;
  }
  frame.stamp_ns -= camera_jump_ns_;
  const TimeNs stamp_ns = frame.stamp_ns;
  if (!options_.camera) {
    Skip(Sensor::kCamera, stamp_ns, "the session is one without a camera");
    return;
  }
  const TimeNs imu_ns = stamp_ns + frame_offset_ns_;
  if (imu_ns < processed_ns_) {
    RefuseLate(Sensor::kCamera, stamp_ns, processed_ns_ - imu_ns);
    return;
  }
  if (stamp_ns <= last_frame_ns_) {
    RefuseLate(Sensor::kCamera, stamp_ns, last_frame_ns_ - stamp_ns);
    return;
  }
  if (!frames_.emplace(stamp_ns, std::move(frame)).second) {
    SkipTwice(Sensor::kCamera, stamp_ns);
    return;
  }
  Process();
  if (frames_.size() > options_.max_waiting) {
    const TimeNs oldest_ns = frames_.begin()->first;
    frames_.erase(frames_.begin());
    Skip(Sensor::kCamera, oldest_ns,
         Format("the IMU does not reach it, and %zu frames wait", frames_.size()));
  }
}

void Session::AddGnss(ObservationEpoch epoch) {
  AddGnss(std::make_shared<const ObservationEpoch>(std::move(epoch)));
}

void Session::AddGnss(std::shared_ptr<const ObservationEpoch> epoch) {
  GnssRun* run = loop_.gnss();
  if (run == nullptr) {
    SkipUnused(Sensor::kGnss, epoch->stamp_ns, "GNSS");
  } else if (!failed() && run->Add(std::move(epoch), processed_ns_)) {
    ProcessAfter(run);
  }
}

void Session::AddMeasurement(const Measurement& measurement) {
  const Sensor sensor = SensorOf(measurement);
  MeasurementRun* run = loop_.measurements(sensor);
  if (run == nullptr) {
    SkipUnused(sensor, StampOf(measurement), PluralNameOf(sensor));
  } else if (!failed() && run->Add(measurement, processed_ns_)) {
    ProcessAfter(run);
  }
}

void Session::SkipUnused(Sensor sensor, TimeNs stamp_ns, const char* name) {
  if (!failed()) {
    Skip(sensor, stamp_ns, std::string("the session is one without ") + name);
  }
}

void Session::ProcessAfter(SensorRun* arrival) {
  Process();
  if (arrival->waiting() > options_.max_waiting) {
    arrival->SkipNext();
  }
}

void Session::AddCatalog(TimeNs from_tag_ns, std::shared_ptr<const SatelliteCatalog> catalog) {
  if (GnssRun* run = loop_.gnss()) {
    run->feed().AddCatalog(from_tag_ns, std::move(catalog));
  }
}

void Session::AdvanceTo(TimeNs imu_ns) {
  advanced_ns_ = std::max(advanced_ns_, imu_ns);
  if (const std::optional<ImuSample> released = leap_.Release(imu_ns)) {
    TakeImu(*released);
  }
  Process();
}

TimeNs Session::Watermark() {
  const TimeNs newest_ns = loop_.imu().newest_ns();
  if (!options_.live || newest_ns == INT64_MIN) {
    return advanced_ns_;
  }
  double lateness_s = options_.camera ? options_.lateness.camera_s : 0;
  for (const SensorRun* sensor : loop_.sensors()) {
    lateness_s = std::max(lateness_s, sensor->lateness_s());
  }
  return std::max(advanced_ns_, newest_ns - SecondsToNs(lateness_s));
}

Session::Due Session::NextDue() {
  Due due;
  if (!frames_.empty()) {
    due.imu_ns = frames_.begin()->first + frame_offset_ns_;
  }
  for (SensorRun* sensor : loop_.sensors()) {
    const std::optional<TimeNs> imu_ns = sensor->NextImuTime();
    if (imu_ns && *imu_ns < due.imu_ns) {
      due = {sensor, *imu_ns};
    }
  }
  return due;
}

bool Session::IsReady(const Due& due) {
  const bool is_frame = due.sensor == nullptr;
  if (is_frame && frames_.empty()) {
    return false;
  }
  const bool is_epoch = !is_frame && due.sensor->sensor() == Sensor::kGnss;
  const TimeNs needed_ns = due.imu_ns + (is_frame ? loop_.FrameLead() : is_epoch ? loop_.EpochLead() : 0);
  // Another message of the same time would be of another sensor: it comes after the frame.
  const auto passed = [&](TimeNs watermark) {
    return is_frame ? needed_ns <= watermark : needed_ns < watermark;
  };
  if (passed(advanced_ns_)) {
    return true;
  }
  const std::optional<TimeNs> reaching_ns = loop_.imu().FirstAtOrAfter(needed_ns);
  return passed(Watermark()) && reaching_ns &&
         loop_.imu().newest_ns() - *reaching_ns >= SecondsToNs(options_.lateness.imu_s);
}

void Session::Process() {
  while (!failed()) {
    const Due due = NextDue();
    const bool ready = IsReady(due);
    const TimeNs now_ns = std::min(ready ? due.imu_ns : Watermark(), loop_.imu().newest_ns());
    if (now_ns != INT64_MIN) {
      loop_.PassTime(now_ns);
    }
    if (!ready) {
      return;
    }
    processed_ns_ = std::max(processed_ns_, due.imu_ns);
    ProcessNext(due.sensor);
  }
}

void Session::ProcessNext(SensorRun* sensor) {
  if (sensor == nullptr) {
    ProcessNextFrame();
  } else if (sensor->sensor() == Sensor::kGnss) {
    ProcessNextEpoch();
  } else {
    loop_.ProcessMessage(sensor);
  }
}

void Session::ProcessNextFrame() {
  TrackFrame frame = std::move(frames_.extract(frames_.begin()).mapped());
  const Eigen::Vector3d gyro_bias =
      running() ? loop_.estimator().Latest().bias.gyro : Eigen::Vector3d::Zero();
  if (const std::optional<TimeNs> jump_ns =
          camera_clock_.FindJump(frame, frame.stamp_ns + frame_offset_ns_, gyro_bias)) {
    TakeBackJump(*jump_ns, &frame);
  }
  last_frame_ns_ = frame.stamp_ns;
  loop_.ProcessFrame(frame);
  frame_offset_ns_ = loop_.ImuTime(frame.stamp_ns) - frame.stamp_ns;
}

void Session::TakeBackJump(TimeNs jump_ns, TrackFrame* frame) {
  camera_jump_ns_ += jump_ns;
  frame->stamp_ns -= jump_ns;
  std::map<TimeNs, TrackFrame> waiting;
  for (auto& [stamp_ns, later] : frames_) {
    later.stamp_ns -= jump_ns;
    waiting.emplace(stamp_ns - jump_ns, std::move(later));
  }
  frames_ = std::move(waiting);
  processed_ns_ = running() ? loop_.state_ns() : processed_ns_ - jump_ns;
  loop_.TellCameraJump(SecondsBetween(0, jump_ns));
}

void Session::ProcessNextEpoch() {
  const bool was_running = running();
  loop_.ProcessEpoch();
  if (!was_running && running()) {
    processed_ns_ = loop_.state_ns();  // a start without a camera finds the time offset too
  }
}

std::vector<SessionEvent> Session::TakeEvents() {
  return std::exchange(events_, {});
}

Result<NewestState> Session::Newest() {
  if (!running()) {
    return Status::Diverged("there is no estimate now");
  }
  const NavEstimate last = loop_.estimator().Latest();
  DeadReckoning reckoning(config_.imu.Scaled(rig_.imu_noise), config_.imu.gravity_mps2,
                          config_.imu.max_gap_s);
  reckoning.Reset(last);
  for (const ImuSample& sample : loop_.imu().Since(last.stamp_ns)) {
    reckoning.AddImu(sample);
  }
  NewestState newest;
  newest.estimate = reckoning.At(loop_.imu().newest_ns()).value_or(last);
  newest.v_B = newest.estimate.nav.R_WB.transpose() * newest.estimate.nav.v_WB;
  newest.omega_B = loop_.imu().newest_gyro() - newest.estimate.bias.gyro;
  return newest;
}

size_t Session::held() {
  size_t count = loop_.imu().size() + (leap_.holds() ? 1 : 0) + frames_.size() + events_.size();
  for (const SensorRun* sensor : loop_.sensors()) {
    count += sensor->waiting();
  }
  return count;
}

void Session::Skip(Sensor sensor, TimeNs stamp_ns, std::string reason) {
  events_.emplace_back(SkippedEvent{sensor, stamp_ns, std::move(reason)});
}

void Session::SkipTwice(Sensor sensor, TimeNs stamp_ns) {
  Skip(sensor, stamp_ns, "there is one with this stamp already");
}

void Session::RefuseLate(Sensor sensor, TimeNs stamp_ns, TimeNs by_ns) {
  events_.emplace_back(TooLateEvent{sensor, stamp_ns, SecondsBetween(0, by_ns)});
}

}  // namespace alidade
