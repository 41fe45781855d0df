#include "eval/run/fix_run.h"

#include <cmath>
#include <utility>

namespace alidade {

FixRun::FixRun(const EstimatorConfig& config, const RigCalibration& rig, bool with_gnss, Estimator* estimator,
               std::vector<SessionEvent>* events)
    : estimator_(*estimator),
      events_(*events),
      feed_(rig, with_gnss),
      aligner_(config.fix, rig.fixes, feed_.enu()),
      with_gnss_(with_gnss) {}

Result<bool> FixRun::TakeFix(bool running) {
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
    events_.emplace_back(SkippedEvent{Sensor::kFix, stamp_ns, "the estimate is lost"});
    return false;
  }
  const Status status = estimator_.AddFix(fix);
  if (status.code() == StatusCode::kInput) {
    events_.emplace_back(SkippedEvent{Sensor::kFix, stamp_ns, status.message()});
    return false;
  }
  return status.ok() ? Result<bool>(true) : status;
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
      events_.emplace_back(WaitingEvent{Sought::kAlignment, stamp_ns, waiting_for_});
    }
    return alignment;
  }
  ALIDADE_RETURN_IF_ERROR(estimator_.Align(*alignment));
  aligned_ = true;
  alignment_ = alignment;
  AlignedEvent event;
  event.global.enu = alignment->enu;
  event.global.source = GlobalFrame::Source::kFixes;
  event.global.stamp_ns = stamp_ns;
  event.global.yaw_rad = alignment->yaw_rad;
  event.global.yaw_std_rad = std::sqrt(alignment->covariance(0, 0));
  event.alignment = *alignment;
  event.estimate = estimator_.Latest();
  events_.emplace_back(std::move(event));
  return alignment;
}

void FixRun::AlignedByGnss(const EnuFrame& enu) {
  feed_.SetFrame(enu);
  aligned_ = true;
}

Status FixRun::Realign() {
  return alignment_ ? estimator_.Align(AlreadyAligned(*alignment_, estimator_.Latest().stamp_ns))
                    : Status::Ok();
}

}  // namespace alidade
