#include "eval/run/session.h"

#include <algorithm>
#include <utility>

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
      imu_clock_(rig_, config_.vision.pixel_noise_px),
      frame_offset_ns_(loop_.ImuTime(0)) {}

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

TimeNs Session::LeadOf(const Due& due) const {
  if (due.sensor == nullptr) {
    return loop_.FrameLead();
  }
  return due.sensor->sensor() == Sensor::kGnss ? loop_.EpochLead() : 0;
}

bool Session::ImuReaches(TimeNs imu_ns) {
  const std::optional<TimeNs> reaching_ns = loop_.imu().FirstAtOrAfter(imu_ns);
  return reaching_ns && loop_.imu().newest_ns() - *reaching_ns >= SecondsToNs(options_.lateness.imu_s);
}

bool Session::IsReady(const Due& due) {
  const bool is_frame = due.sensor == nullptr;
  if (is_frame && frames_.empty()) {
    return false;
  }
  const TimeNs needed_ns = due.imu_ns + LeadOf(due);
  // Another message of the same time would be of another sensor: it comes after the frame.
  const auto passed = [&](TimeNs watermark) {
    return is_frame ? needed_ns <= watermark : needed_ns < watermark;
  };
  return passed(advanced_ns_) || (passed(Watermark()) && ImuReaches(needed_ns));
}

void Session::Process() {
  while (!failed()) {
    const Due due = NextDue();
    // A jump that was found leaves samples to be awaited.
    const bool ready = IsReady(due) && !IsInDoubt(due) && IsReady(due);
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

Eigen::Vector3d Session::GyroBias() const {
  return running() ? loop_.estimator().Latest().bias.gyro : Eigen::Vector3d::Zero();
}

void Session::ProcessNextFrame() {
  TrackFrame frame = std::move(frames_.extract(frames_.begin()).mapped());
  if (const std::optional<TimeNs> jump_ns =
          camera_clock_.FindJump(frame, frame.stamp_ns + frame_offset_ns_, GyroBias())) {
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
  loop_.OnClockJump("camera", SecondsBetween(0, jump_ns));
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

}  // namespace alidade
