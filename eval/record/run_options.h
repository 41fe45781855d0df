#pragma once

#include <atomic>
#include <functional>
#include <string>

#include "core/navigation_state.h"
#include "core/rig_calibration.h"
#include "core/status.h"
#include "core/time.h"
#include "eval/trajectory/trajectory.h"

namespace alidade {

/// What a run is given beside its configuration and its log.
struct RunOptions {
  const Trajectory* truth = nullptr;         ///< read only by init.method truth
  const RigCalibration* true_rig = nullptr;  ///< what online calibration is compared with; may be null
  unsigned seed = 1;                         ///< draws the prior of init.method truth
  /// Takes the place of truth for init.method truth: the first state at a frame's IMU time.
  std::function<Result<NavEstimate>(TimeNs imu_ns)> start_state;
  const std::atomic<bool>* stop = nullptr;  ///< polled once a frame
  std::function<void(size_t frames_done, size_t frames)> progress;
  /// Where records of a long run go (RunResult::spool), so that memory does not grow with it; empty: they
  /// stay in memory. Not for an audited run, nor for an estimator that looks back.
  std::string spool_folder;
  /// Fills RunRecord::observability when the back end is the filter. Its time counts as the estimator's.
  bool audit = false;
};

}  // namespace alidade
