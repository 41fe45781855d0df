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
  if (config.init.method == InitMethod::kTruth && options.camera && !options.start_state) {
    return Status::Config(
        "init.method: found truth, but no state was given; expected static, dynamic or auto, or "
        "SessionOptions::start_state");
  }
  if (!options.camera && (!config.gnss.enabled || !options.gnss)) {
    return Status::Config("gnss.enabled: a session without a camera needs GNSS; expected true, and a setup");
  }
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
      frame_offset_ns_(loop_.ImuTime(0)) {}

void Session::AddImu(const ImuSample& sample) {
  if (failed()) {
    return;
  }
  if (!sample.gyro.allFinite() || !sample.accel.allFinite()) {
    Skip(Sensor::kImu, sample.stamp_ns, "not finite");
    return;
  }
  switch (loop_.imu().Add(sample)) {
    case ImuStream::Arrival::kTwice:
      Skip(Sensor::kImu, sample.stamp_ns, "there is one with this stamp already");
      return;
    case ImuStream::Arrival::kTooLate:
      RefuseLate(Sensor::kImu, sample.stamp_ns, loop_.imu().delivered_ns() - sample.stamp_ns);
      return;
    case ImuStream::Arrival::kTaken:
      break;
  }
  Process();
}

void Session::AddFrame(TrackFrame frame) {
  if (failed()) {
    return;
  }
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
    Skip(Sensor::kCamera, stamp_ns, "there is one with this stamp already");
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
  if (failed()) {
    return;
  }
  const TimeNs tag_ns = epoch->stamp_ns;
  GnssFeed* feed = loop_.epochs();
  if (feed == nullptr) {
    Skip(Sensor::kGnss, tag_ns, "the session is one without GNSS");
    return;
  }
  const TimeNs expected_ns = feed->ExpectedStamp(tag_ns).value_or(INT64_MAX);
  if (expected_ns < processed_ns_) {
    RefuseLate(Sensor::kGnss, tag_ns, processed_ns_ - expected_ns);
    return;
  }
  switch (feed->Add(std::move(epoch))) {
    case GnssFeed::Arrival::kTwice:
      Skip(Sensor::kGnss, tag_ns, "there is one with this tag already");
      return;
    case GnssFeed::Arrival::kTooLate:
      RefuseLate(Sensor::kGnss, tag_ns, feed->last_tag_ns() - tag_ns);
      return;
    case GnssFeed::Arrival::kTaken:
      break;
  }
  Process();
  if (feed->size() > options_.max_waiting) {
    const TimeNs oldest_ns = feed->Next()->measurements.tag_ns;
    feed->Pop();
    Skip(Sensor::kGnss, oldest_ns, Format("the IMU does not reach it, and %zu epochs wait", feed->size()));
  }
}

void Session::AddFix(const PositionFix& fix) {
  if (failed()) {
    return;
  }
  FixFeed* feed = loop_.fixes();
  if (feed == nullptr) {
    Skip(Sensor::kFix, fix.stamp_ns, "the session is one without position fixes");
    return;
  }
  if (feed->HasSensor(fix.sensor) && feed->ImuTime(fix) < processed_ns_) {
    RefuseLate(Sensor::kFix, fix.stamp_ns, processed_ns_ - feed->ImuTime(fix));
    return;
  }
  switch (feed->Add(fix)) {
    case FixFeed::Arrival::kNoSensor:
      Skip(Sensor::kFix, fix.stamp_ns, Format("the rig has no fix sensor %d", fix.sensor));
      return;
    case FixFeed::Arrival::kUnrelated:
      Skip(Sensor::kFix, fix.stamp_ns,
           Format("the frame of fix sensor %d is not related to that of the run", fix.sensor));
      return;
    case FixFeed::Arrival::kTwice:
      Skip(Sensor::kFix, fix.stamp_ns, "there is one with this stamp already");
      return;
    case FixFeed::Arrival::kTooLate:
      RefuseLate(Sensor::kFix, fix.stamp_ns, feed->last_ns() - feed->ImuTime(fix));
      return;
    case FixFeed::Arrival::kTaken:
      break;
  }
  Process();
  if (feed->size() > options_.max_waiting) {
    const TimeNs oldest_ns = feed->next_stamp_ns();
    feed->Pop();
    Skip(Sensor::kFix, oldest_ns, Format("the IMU does not reach it, and %zu fixes wait", feed->size()));
  }
}

void Session::AddCatalog(TimeNs from_tag_ns, std::shared_ptr<const SatelliteCatalog> catalog) {
  if (GnssFeed* feed = loop_.epochs()) {
    feed->AddCatalog(from_tag_ns, std::move(catalog));
  }
}

void Session::AdvanceTo(TimeNs imu_ns) {
  advanced_ns_ = std::max(advanced_ns_, imu_ns);
  Process();
}

TimeNs Session::Watermark() {
  const TimeNs newest_ns = loop_.imu().newest_ns();
  if (!options_.live || newest_ns == INT64_MIN) {
    return advanced_ns_;
  }
  const double camera_s = options_.camera ? options_.lateness.camera_s : 0;
  const double gnss_s = loop_.epochs() != nullptr ? options_.lateness.gnss_s : 0;
  const double fix_s = loop_.fixes() != nullptr ? options_.lateness.fix_s : 0;
  return std::max(advanced_ns_, newest_ns - SecondsToNs(std::max({camera_s, gnss_s, fix_s})));
}

Session::Due Session::NextDue() {
  Due due;
  if (!frames_.empty()) {
    due.imu_ns = frames_.begin()->first + frame_offset_ns_;
  }
  GnssFeed* feed = loop_.epochs();
  if (const GnssEpoch* epoch = feed != nullptr ? feed->Next() : nullptr) {
    if (epoch->stamp_ns < due.imu_ns) {
      due = {Sensor::kGnss, epoch->stamp_ns};
    }
  }
  FixFeed* fixes = loop_.fixes();
  if (const PositionFix* fix = fixes != nullptr ? fixes->Next() : nullptr) {
    if (fix->stamp_ns < due.imu_ns) {
      due = {Sensor::kFix, fix->stamp_ns};
    }
  }
  return due;
}

bool Session::IsReady(const Due& due) {
  const bool is_frame = due.sensor == Sensor::kCamera;
  if (is_frame && frames_.empty()) {
    return false;
  }
  const TimeNs needed_ns = due.imu_ns + (due.sensor == Sensor::kGnss ? loop_.EpochLead() : 0);
  // Another message of the same time would be an epoch or a fix: it comes after the frame.
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

void Session::ProcessNext(Sensor sensor) {
  if (sensor == Sensor::kCamera) {
    ProcessNextFrame();
  } else if (sensor == Sensor::kGnss) {
    ProcessNextEpoch();
  } else {
    loop_.ProcessFix();
  }
}

void Session::ProcessNextFrame() {
  const TrackFrame frame = std::move(frames_.extract(frames_.begin()).mapped());
  last_frame_ns_ = frame.stamp_ns;
  loop_.ProcessFrame(frame);
  frame_offset_ns_ = loop_.ImuTime(frame.stamp_ns) - frame.stamp_ns;
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
  const GnssFeed* feed = loop_.epochs();
  const FixFeed* fixes = loop_.fixes();
  return loop_.imu().size() + frames_.size() + (feed != nullptr ? feed->size() : 0) +
         (fixes != nullptr ? fixes->size() : 0) + events_.size();
}

void Session::Skip(Sensor sensor, TimeNs stamp_ns, std::string reason) {
  events_.emplace_back(SkippedEvent{sensor, stamp_ns, std::move(reason)});
}

void Session::RefuseLate(Sensor sensor, TimeNs stamp_ns, TimeNs by_ns) {
  events_.emplace_back(TooLateEvent{sensor, stamp_ns, SecondsBetween(0, by_ns)});
}

}  // namespace alidade
