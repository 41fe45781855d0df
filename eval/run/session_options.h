#pragma once

#include <functional>
#include <optional>

#include "core/estimator_config.h"
#include "core/navigation_state.h"
#include "core/status.h"
#include "eval/run/gnss_feed.h"

namespace alidade {

/// How late a message may come: while the newest IMU stamp received is less than this ahead of the message's
/// IMU time. What is processed waits that long.
struct Lateness {
  double imu_s = 0;
  double camera_s = 0;
  double gnss_s = 0;
  double fix_s = 0;  ///< of position fixes
};

struct SessionOptions {
  Lateness lateness;
  bool camera = true;             ///< false: GNSS and IMU alone
  std::optional<GnssSetup> gnss;  ///< with it, and gnss.enabled, the session takes epochs
  /// The first state, asked for at the IMU time of each frame until it answers; read by init.method truth
  /// alone. Such as a known pose of a dock.
  std::function<Result<NavEstimate>(TimeNs imu_ns)> start_state;
  /// An estimate older than this is given up: no frame, epoch or measurement came that could be used. Nor
  /// does a start look back further.
  double max_silence_s = 60;
  /// Frames, epochs or measurements of one sensor that may wait for the IMU; the oldest is skipped when one
  /// more comes.
  size_t max_waiting = 1000;
  /// False: lateness does not count, and nothing is processed before Session::AdvanceTo or Flush.
  bool live = true;

  /// kConfig: they contradict the configuration, which is valid by itself.
  [[nodiscard]] Status Validate(const EstimatorConfig& config) const;
};

}  // namespace alidade
