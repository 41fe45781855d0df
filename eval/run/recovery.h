#pragma once

#include <memory>
#include <optional>
#include <string>

#include "core/estimator/estimator.h"
#include "core/rig_calibration.h"
#include "eval/run/dead_reckoning.h"
#include "eval/run/health_monitor.h"
#include "frontend/initialization/initializer.h"
#include "gnss/alignment/alignment.h"

namespace alidade {

/// Loss of the estimate and the way back: checks every state, and once one is given up looks for a new start
/// in the data that follow, placed where dead reckoning from the last sound state leads.
class Recovery {
 public:
  /// All must outlive the object. A start needs frames: without a camera nothing is recovered.
  Recovery(const EstimatorConfig& config, const RigCalibration& rig, bool camera);

  /// Every sample, in order, from that before the first state on.
  void AddImu(const ImuSample& sample);
  /// A sample to which the search for a new start does not reach back.
  void PassOver(const ImuSample& sample) { reckoning_.AddImu(sample); }

  /// Empty while the state is sound, else why it is not (HealthMonitor). Empty when recovery is off.
  [[nodiscard]] std::string Check(const NavEstimate& estimate, const FrameStatistics& statistics);
  /// Gives the estimate up. False when no new start may be sought: recovery is off, the estimator looks back,
  /// or there never was a sound state.
  bool GiveUp(TimeNs stamp_ns);
  [[nodiscard]] bool lost() const { return initializer_ != nullptr; }
  [[nodiscard]] TimeNs lost_ns() const { return lost_ns_; }
  /// The world was turned: the last sound state is turned with it.
  void Turn(const GnssAlignment& alignment);

  // While lost.
  /// The state to go on from, or why there is none yet.
  Result<NavEstimate> TryStart(const TrackFrame& frame);
  [[nodiscard]] const std::string& method() const { return initializer_->method(); }
  [[nodiscard]] const std::string& report() const { return initializer_->report(); }
  /// The estimator has begun there; not lost any more.
  void Started(const NavEstimate& start);

 private:
  void SetSound(const NavEstimate& estimate);

  const EstimatorConfig& config_;
  const RigCalibration& rig_;
  const bool enabled_;
  HealthMonitor monitor_;
  DeadReckoning reckoning_;  ///< from last_sound_
  std::optional<NavEstimate> last_sound_;
  TimeNs lost_ns_ = 0;
  std::unique_ptr<Initializer> initializer_;  ///< while lost
};

}  // namespace alidade
