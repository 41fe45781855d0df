#include "eval/run/fix_feed.h"

#include "core/check.h"
#include "gnss/base/anchor_llh.h"

namespace alidade {

FixFeed::FixFeed(const RigCalibration& rig, bool with_gnss) : sensors_(rig.fixes) {
  frames_.reserve(sensors_.size());
  for (const FixSensor& sensor : sensors_) {
    frames_.push_back(sensor.anchor_llh_deg ? std::optional(EnuFrameAtLlh(*sensor.anchor_llh_deg))
                                            : std::nullopt);
  }
  on_earth_ = with_gnss || (!frames_.empty() && frames_.front());
  if (on_earth_ && rig.gnss.anchor_E) {
    enu_ = EnuFrame::At(*rig.gnss.anchor_E);
  } else if (on_earth_ && !with_gnss) {
    enu_ = frames_.front();
  }
}

void FixFeed::SetFrame(const EnuFrame& enu) {
  enu_ = enu;
  on_earth_ = true;
}

bool FixFeed::IsRelated(int sensor) const {
  return on_earth_ ? frames_[static_cast<std::size_t>(sensor)].has_value() : sensor == 0;
}

FixFeed::Arrival FixFeed::Add(const PositionFix& fix) {
  if (!HasSensor(fix.sensor)) {
    return Arrival::kNoSensor;
  }
  if (!IsRelated(fix.sensor)) {
    return Arrival::kUnrelated;
  }
  const std::pair<TimeNs, int> key(ImuTime(fix), fix.sensor);
  if (key <= last_) {
    return Arrival::kTooLate;
  }
  return waiting_.emplace(key, fix).second ? Arrival::kTaken : Arrival::kTwice;
}

const PositionFix* FixFeed::Next() {
  if (waiting_.empty()) {
    return nullptr;
  }
  const auto& [key, fix] = *waiting_.begin();
  next_ = fix;
  next_.stamp_ns = key.first;
  const std::optional<EnuFrame>& frame = frames_[static_cast<std::size_t>(fix.sensor)];
  if (enu_ && frame) {
    const Eigen::Matrix3d turn = enu_->R_EN.transpose() * frame->R_EN;
    const Eigen::Matrix3d covariance = turn * fix.covariance * turn.transpose();
    next_.p_A = enu_->FromEcef(frame->ToEcef(fix.p_A));
    next_.covariance = 0.5 * (covariance + covariance.transpose());
  }
  return &next_;
}

void FixFeed::Pop() {
  CHECK(!waiting_.empty());
  last_ = waiting_.begin()->first;
  waiting_.erase(waiting_.begin());
}

}  // namespace alidade
