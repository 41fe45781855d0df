#include "eval/run/recovery.h"

#include <algorithm>
#include <vector>

#include "core/imu_buffer.h"
#include "core/imu_propagation.h"

namespace alidade {

Recovery::Recovery(const EstimatorConfig& config, const MeasurementLog& log, RunResult* result)
    : config_(config), log_(log), result_(*result), monitor_(config.recovery) {}

std::string Recovery::Check(const NavEstimate& estimate, const FrameStatistics& statistics) {
  if (!config_.recovery.enabled || config_.backend == Backend::kBatch) {
    return {};
  }
  std::string reason = monitor_.Check(estimate, statistics);
  if (reason.empty() && (monitor_.supported() || !last_sound_)) {
    last_sound_ = estimate;
  }
  return reason;
}

bool Recovery::GiveUp(TimeNs stamp_ns, const std::string& reason) {
  if (!config_.recovery.enabled || config_.backend == Backend::kBatch || !last_sound_) {
    return false;
  }
  result_.restarts.push_back({stamp_ns, reason, 0, {}});
  if (!result_.records.empty()) {
    result_.records.back().status = "lost";
    result_.records.back().reason = reason;
  }
  EstimatorConfig config = config_;
  // Truth is for the first start alone: a run that gets lost has to find itself.
  config.init.method = config.init.method == InitMethod::kTruth ? InitMethod::kAuto : config.init.method;
  initializer_ = std::make_unique<Initializer>(config, log_.rig);
  refusal_ = "there is no frame";
  return true;
}

Result<NavEstimate> Recovery::TryStart(const TrackFrame& frame, size_t next_imu) {
  const Result<NavEstimate> start = initializer_->AddFrame(frame);
  if (!start.ok()) {
    refusal_ = start.message();
    return start;
  }
  return ContinueFrom(*last_sound_, Reckoned(start->stamp_ns, next_imu), *start);
}

void Recovery::Started(const NavEstimate& start) {
  result_.restarts.back().restarted_ns = start.stamp_ns;
  result_.restarts.back().init_report = initializer_->report();
  initializer_.reset();
  monitor_.Reset();
  last_sound_ = start;
}

std::string Recovery::Message() const {
  return "lost at " + FormatSeconds(result_.restarts.back().lost_ns) + " s (" +
         result_.restarts.back().reason + ") and not started again: " + refusal_;
}

/// The last sound state propagated over the IMU alone. Where the IMU has a hole it stays where it was.
NavEstimate Recovery::Reckoned(TimeNs stamp_ns, size_t next_imu) const {
  NavEstimate reckoned = *last_sound_;
  ImuBuffer buffer(config_.imu.max_gap_s);
  const auto first =
      std::upper_bound(log_.imu.begin(), log_.imu.end(), reckoned.stamp_ns,
                       [](TimeNs stamp, const ImuSample& sample) { return stamp < sample.stamp_ns; });
  for (auto sample = first == log_.imu.begin() ? first : first - 1;
       sample != log_.imu.begin() + static_cast<std::ptrdiff_t>(next_imu); ++sample) {
    static_cast<void>(buffer.Add(*sample).ok());
  }
  std::vector<ImuSample> samples;
  if (buffer.Interval(reckoned.stamp_ns, stamp_ns, &samples).ok()) {
    // Where the IMU is not usable the state stays as it is, as in a gap.
    static_cast<void>(PropagateEstimate(samples, config_.imu.Scaled(log_.rig.imu_noise),
                                        GravityInWorld(config_.imu.gravity_mps2), &reckoned));
  }
  reckoned.stamp_ns = stamp_ns;
  return reckoned;
}

}  // namespace alidade
