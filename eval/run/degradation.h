#pragma once

#include <string>

#include "core/estimator/estimator.h"
#include "core/track_frame.h"

namespace alidade {

/// Tells when an estimate goes on without what it needs, though nothing contradicts it: frames without
/// tracks, images that do not change, an IMU that was silent.
class Degradation {
 public:
  /// Without tracks for this long the estimate is dead reckoning.
  static constexpr double kMaxBlindS = 0.15;
  /// After a silence of the IMU.
  static constexpr double kSettlingS = 0.5;
  /// Fewer equal pixels may be chance.
  static constexpr size_t kMinFrozen = 8;

  /// Every sample that is delivered, in order.
  void OnImu(TimeNs stamp_ns);
  /// Whether the frame shows what the one before showed: every track of both, at least kMinFrozen, on the
  /// very same pixel. A sensor's noise moves each of them even at rest: it is the old image under a new
  /// stamp, and says nothing. Every frame, in order.
  bool IsFrozen(const TrackFrame& frame);
  /// Why the estimate after a frame at `imu_ns` is degraded; empty: it is not. Every frame, in order, after
  /// IsFrozen of it.
  [[nodiscard]] std::string Check(TimeNs imu_ns, const FrameStatistics& statistics);
  /// After a start.
  void Reset() { sighted_ns_ = INT64_MIN; }

 private:
  TimeNs last_imu_ns_ = INT64_MIN;
  TimeNs silent_until_ns_ = INT64_MIN;
  double silence_s_ = 0;
  TimeNs sighted_ns_ = INT64_MIN;  ///< the last frame with tracks
  std::vector<TrackObservation> shown_;
  bool frozen_ = false;
};

}  // namespace alidade
