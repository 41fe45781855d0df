#pragma once

#include <string>

#include "core/estimator/estimator.h"
#include "core/recovery_config.h"

namespace alidade {

/// Detects a lost estimate: not finite, with an invalid covariance, with speed or biases beyond the limits of
/// RecoveryConfig, or contradicted by its tracks for recovery.max_suspect_s without a supporting frame in
/// between. A frame supports the state when at least half of the due tracks could be used without the
/// consensus gate (FrameStatistics::suspect), or at rest. It contradicts the state when more failed. A frame
/// without due tracks does neither.
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

/// The state of a new start, placed at the expected pose of the rig: a new start has an arbitrary yaw and
/// origin. `reckoned` is the last valid estimate, propagated with the IMU to the stamp of `start`, covariance
/// included; its yaw and position, with their covariance, replace those of `start`, whose other coordinates
/// keep theirs. Canonical chart throughout.
///
/// Velocity and tilt are known to both; their difference measures the error of the dead reckoning. It is
/// added to the standard deviation of yaw and, multiplied by the elapsed time, of position. If the velocity
/// difference exceeds the start's own speed, the dead reckoning is dropped and the rig is assumed to be near
/// its last valid position.
[[nodiscard]] NavEstimate ContinueFrom(const NavEstimate& sound, const NavEstimate& reckoned,
                                       const NavEstimate& start);

}  // namespace alidade
