#include "eval/run/recovery.h"

namespace alidade {

Recovery::Recovery(const EstimatorConfig& config, const RigCalibration& rig, bool camera)
    : config_(config),
      rig_(rig),
      enabled_(camera && config.recovery.enabled && config.backend != Backend::kBatch),
      monitor_(config.recovery),
      reckoning_(config.imu.Scaled(rig.imu_noise), config.imu.gravity_mps2, config.imu.max_gap_s) {}

void Recovery::AddImu(const ImuSample& sample) {
  if (enabled_) {
    reckoning_.AddImu(sample);
  }
  if (lost()) {
    initializer_->AddImu(sample);
  }
}

std::string Recovery::Check(const NavEstimate& estimate, const FrameStatistics& statistics) {
  if (!enabled_) {
    return {};
  }
  std::string reason = monitor_.Check(estimate, statistics);
  if (reason.empty() && (monitor_.supported() || !last_sound_)) {
    SetSound(estimate);
  }
  return reason;
}

bool Recovery::GiveUp(TimeNs stamp_ns) {
  if (!enabled_ || !last_sound_) {
    return false;
  }
  lost_ns_ = stamp_ns;
  EstimatorConfig config = config_;
  // A given state is for the first start alone: once lost, it has to be found.
  config.init.method = config.init.method == InitMethod::kTruth ? InitMethod::kAuto : config.init.method;
  // Dead reckoning leaves the yaw of a new start uncertain by up to a radian, and the smoother's prior is
  // linear in it: where a rough scale is corrected afterwards, the velocity turns against its prior and seems
  // to determine the yaw.
  const bool sharp = config.backend == Backend::kSmoother;
  initializer_ = std::make_unique<Initializer>(config, rig_, sharp ? ScaleDemand::Sharp() : ScaleDemand());
  return true;
}

void Recovery::Turn(const GnssAlignment& alignment) {
  if (last_sound_) {
    last_sound_ = TurnIntoEnu(alignment, *last_sound_);
    reckoning_.Reset(TurnIntoEnu(alignment, reckoning_.Here()));  // keeps the samples after it
  }
}

Result<NavEstimate> Recovery::TryStart(const TrackFrame& frame) {
  Result<NavEstimate> start = initializer_->AddFrame(frame);
  if (!start.ok()) {
    return start;
  }
  // Where the IMU has a hole the rig is taken to be where it was.
  NavEstimate reckoned = reckoning_.At(start->stamp_ns).value_or(*last_sound_);
  reckoned.stamp_ns = start->stamp_ns;
  return ContinueFrom(*last_sound_, reckoned, *start);
}

void Recovery::Started(const NavEstimate& start) {
  initializer_.reset();
  monitor_.Reset();
  SetSound(start);
}

void Recovery::SetSound(const NavEstimate& estimate) {
  last_sound_ = estimate;
  reckoning_.Reset(estimate);
}

}  // namespace alidade
