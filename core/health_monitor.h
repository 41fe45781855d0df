#pragma once

#include <string>

#include "core/estimator.h"

namespace alidade {

/// Tells when an estimate is lost although its estimator goes on: not finite, its covariance no covariance,
/// faster or more biased than the limits of RecoveryConfig, or contradicted by its tracks for
/// recovery.max_suspect_s without a frame in between that supports it. A frame supports the
/// state when at least half of the tracks that were due could be used without force
/// (FrameStatistics::suspect), or at rest; it contradicts when more failed; without tracks that were due it
/// says nothing.
class HealthMonitor {
 public:
  explicit HealthMonitor(const RecoveryConfig& config) : config_(config) {}

  /// Empty while the estimate is sound, else why it is not, with the figure and its limit.
  [[nodiscard]] std::string Check(const NavEstimate& estimate, const FrameStatistics& statistics);
  /// Whether the last frame supported the state.
  [[nodiscard]] bool supported() const { return supported_; }
  /// Forgets the past: after a start.
  void Reset() { in_doubt_ = false; }

 private:
  RecoveryConfig config_;
  bool supported_ = false;
  bool in_doubt_ = false;
  TimeNs doubted_since_ns_ = 0;
};

/// The state of a new start, moved to where the rig should be: a new start knows neither its yaw nor its
/// position. `reckoned` is the last sound estimate propagated to the stamp of `start`, covariance included;
/// its yaw and position, with their covariance, replace those of `start`, whose other coordinates keep
/// theirs. Canonical chart throughout.
///
/// The start checks the reckoning: velocity and tilt, which both know, disagree as far as the IMU failed
/// meanwhile. The disagreement counts as deviation of yaw and, times the time since, of position. Beyond the
/// start's own speed the reckoning is worth nothing: the rig is then taken to be about where it was.
[[nodiscard]] NavEstimate ContinueFrom(const NavEstimate& sound, const NavEstimate& reckoned,
                                       const NavEstimate& start);

}  // namespace alidade
