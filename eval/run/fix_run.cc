#include "eval/run/fix_run.h"

#include <cmath>
#include <utility>

#include "core/format.h"

namespace alidade {

FixRun::FixRun(const EstimatorConfig& config, const RigCalibration& rig, double lateness_s, bool with_gnss,
               Estimator* estimator, std::vector<SessionEvent>* events)
    : MeasurementRun(SensorOf<PositionFixEntry>(), lateness_s, events),
      estimator_(*estimator),
      sensors_(rig.fixes),
      feed_(rig, with_gnss),
      aligner_(config.fix, rig.fixes, feed_.enu()),
      with_gnss_(with_gnss) {}

bool FixRun::Add(const Measurement& measurement, TimeNs processed_ns) {
  const auto& fix = std::get<PositionFix>(measurement);
  if (feed_.HasSensor(fix.sensor) && feed_.ImuTime(fix) < processed_ns) {
    RefuseLate(fix.stamp_ns, processed_ns - feed_.ImuTime(fix));
    return false;
  }
  switch (feed_.Add(fix)) {
    case FixFeed::Arrival::kNoSensor:
      Skip(fix.stamp_ns, Format("the rig has no fix sensor %d", fix.sensor));
      return false;
    case FixFeed::Arrival::kUnrelated:
      Skip(fix.stamp_ns, Format("the frame of fix sensor %d is not related to that of the run", fix.sensor));
      return false;
    case FixFeed::Arrival::kTwice:
      Skip(fix.stamp_ns, "there is one with this stamp already");
      return false;
    case FixFeed::Arrival::kTooLate:
      RefuseLate(fix.stamp_ns, feed_.last_ns() - feed_.ImuTime(fix));
      return false;
    case FixFeed::Arrival::kTaken:
      break;
  }
  return true;
}

std::optional<TimeNs> FixRun::NextImuTime() {
  const PositionFix* fix = feed_.Next();
  return fix != nullptr ? std::optional(fix->stamp_ns) : std::nullopt;
}

void FixRun::SkipNext() {
  const TimeNs stamp_ns = feed_.next_stamp_ns();
  feed_.Pop();
  Skip(stamp_ns, Format("the IMU does not reach it, and %zu fixes wait", feed_.size()));
}

Result<bool> FixRun::Take(bool running) {
  const PositionFix fix = *feed_.Next();
  const TimeNs stamp_ns = feed_.next_stamp_ns();
  feed_.Pop();
  if (!aligned_) {
    if (!with_gnss_) {
      aligner_.AddFix(fix);
    }
    return false;
  }
  if (!running) {
    Skip(stamp_ns, "the estimate is lost");
    return false;
  }
  const Status status = estimator_.AddMeasurement(fix);
  SetComparison(status.ok() ? Compare(fix) : std::nullopt);
  if (status.code() == StatusCode::kInput) {
    Skip(stamp_ns, status.message());
    return false;
  }
  return status.ok() ? Result<bool>(true) : status;
}

std::optional<AbsoluteComparison> FixRun::Compare(const PositionFix& fix) const {
  const AbsoluteCorrection* correction = estimator_.last_correction();
  if (correction == nullptr) {
    return std::nullopt;
  }
  const PositionFixModel model{sensors_[static_cast<std::size_t>(fix.sensor)].p_BA, fix.p_A};
  return AbsoluteComparison{fix.stamp_ns,
                            fix.sensor,
                            correction->change,
                            correction->covariance,
                            fix.p_A - model.Predict(correction->nav),
                            fix.covariance};
}

Result<std::optional<GnssAlignment>> FixRun::Align(TimeNs stamp_ns) {
  std::optional<GnssAlignment> alignment;
  const NavEstimate latest = estimator_.Latest();
  if (aligned_ || with_gnss_ || latest.stamp_ns != stamp_ns) {  // another stamp: the frame was refused
    return alignment;
  }
  aligner_.AddState(latest);
  alignment = aligner_.TryAlign();
  if (!alignment) {
    if (aligner_.report() != waiting_for_) {
      waiting_for_ = aligner_.report();
      events().emplace_back(WaitingEvent{Sought::kAlignment, stamp_ns, waiting_for_});
    }
    return alignment;
  }
  ALIDADE_RETURN_IF_ERROR(estimator_.Align(*alignment));
  aligned_ = true;
  alignment_ = alignment;
  AlignedEvent event;
  event.global.enu = alignment->enu;
  event.global.source = SensorOf<PositionFixEntry>();
  event.global.stamp_ns = stamp_ns;
  event.global.yaw_rad = alignment->yaw_rad;
  event.global.yaw_std_rad = std::sqrt(alignment->covariance(0, 0));
  event.alignment = *alignment;
  event.estimate = estimator_.Latest();
  events().emplace_back(std::move(event));
  return alignment;
}

void FixRun::AlignedByAnother(const std::optional<EnuFrame>& enu) {
  if (enu) {
    feed_.SetFrame(*enu);
  }
  aligned_ = true;
}

Status FixRun::Realign() {
  if (!alignment_) {
    aligner_.ForgetEstimate();
    return Status::Ok();
  }
  return estimator_.Align(AlreadyAligned(*alignment_, estimator_.Latest().stamp_ns));
}

}  // namespace alidade
