#pragma once

#include <limits>
#include <string>
#include <vector>

#include "core/estimator/measurement_log.h"
#include "core/gnss_config.h"
#include "eval/record/run_result.h"
#include "eval/simulation/simulator_config.h"

namespace alidade {

/// Simulated events of the receiver, or of the position sensor, of a sequence; seconds from its first IMU
/// sample, negative: never.
struct GnssScenario {
  double motion_start_s = 0;
  double outage_start_s = -1;
  double outage_end_s = -1;
  int outage_satellites = 0;  ///< received during the outage
  double clock_jump_s = -1;

  [[nodiscard]] bool HasOutage() const { return outage_start_s >= 0; }
};
/// The events of a simulation, limited to the sequence's `duration_s`. The outage is that of raw GNSS, or of
/// position fixes where there is no receiver.
[[nodiscard]] GnssScenario ScenarioOf(const SimulatorConfig& config, double duration_s);

/// Figures of one run. NaN: does not apply.
struct GnssRunFigures {
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

  double aligned_after_s = kNone;  ///< from the start of motion; never below zero
  double rmse_m = kNone;           ///< position, from the alignment on
  double early_m = kNone;          ///< the same over the first and the last third of that time: a drift shows
  double late_m = kNone;
  double nees_pos = kNone;       ///< mean, ideal 3
  double outage_rmse_m = kNone;  ///< position, while satellites are missing
  double return_error_m = kNone;
  double return_covered = kNone;  ///< 1: every axis of that error is within three deviations, 0: not
  double after_2_s_m = kNone;     ///< position error 2 s after the return
  double jump_step_m = kNone;     ///< largest change of the error between two frames, within 1 s of the jump
};

/// A run with GNSS or position fixes: errors are global, unaligned. Without an alignment all figures are NaN.
[[nodiscard]] GnssRunFigures ScoreGlobalRun(const RunResult& run, const Trajectory& truth, TimeNs start_ns,
                                            const GnssScenario& scenario);
/// A run without them: the figures of the outage, as if yaw and position had been given at its start.
[[nodiscard]] GnssRunFigures ScoreOdometry(const RunResult& run, const Trajectory& truth, TimeNs start_ns,
                                           const GnssScenario& scenario);

/// Position RMSE of the single-point solutions of the log's epochs [m], against truth in the ENU frame at the
/// rig's anchor; NaN without an anchor or a solution.
[[nodiscard]] double SinglePointRmse(const GnssConfig& config, const MeasurementLog& log,
                                     const Trajectory& truth);

}  // namespace alidade
