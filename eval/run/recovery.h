#pragma once

#include <memory>
#include <optional>
#include <string>

#include "core/health_monitor.h"
#include "core/measurement_log.h"
#include "eval/run/run_result.h"
#include "frontend/initialization/initializer.h"

namespace alidade {

/// How a run gets over the loss of its estimate: judges every state, and once one is given up looks for a new
/// start in the data that follow, placed where dead reckoning from the last sound state leads. Writes
/// RunResult::restarts.
class Recovery {
 public:
  /// All must outlive the object.
  Recovery(const EstimatorConfig& config, const MeasurementLog& log, RunResult* result);

  /// Empty while the state is sound, else why it is not (HealthMonitor). Empty when recovery is off.
  [[nodiscard]] std::string Check(const NavEstimate& estimate, const FrameStatistics& statistics);
  /// Gives the estimate up. False when no new start may be sought: recovery is off, the estimator looks back,
  /// or there never was a sound state.
  bool GiveUp(TimeNs stamp_ns, const std::string& reason);
  [[nodiscard]] bool lost() const { return initializer_ != nullptr; }

  // While lost.
  void AddImu(const ImuSample& sample) { initializer_->AddImu(sample); }
  /// The state to go on from, or why there is none yet. `next_imu`: the log's samples before it are
  /// delivered.
  Result<NavEstimate> TryStart(const TrackFrame& frame, size_t next_imu);
  /// The estimator has begun there.
  void Started(const NavEstimate& start);
  /// Why the run ends lost.
  [[nodiscard]] std::string Message() const;

 private:
  [[nodiscard]] NavEstimate Reckoned(TimeNs stamp_ns, size_t next_imu) const;

  const EstimatorConfig& config_;
  const MeasurementLog& log_;
  RunResult& result_;
  HealthMonitor monitor_;
  std::optional<NavEstimate> last_sound_;
  std::unique_ptr<Initializer> initializer_;  ///< while lost
  std::string refusal_;                       ///< of the last attempt
};

}  // namespace alidade
