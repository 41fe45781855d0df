#pragma once

#include <string>

#include "core/status.h"
#include "eval/simulation/simulator_config.h"
#include "eval/simulation/spline_trajectory.h"
#include "eval/trajectory/trajectory.h"

namespace alidade {

/// A recorded trajectory and the smooth motion through it.
struct RecordedMotion {
  std::string path;         ///< file the poses were read from
  Trajectory samples;       ///< its rows that were used, as recorded
  SplineTrajectory motion;  ///< time 0 is the first of them
};

/// The file that holds the poses. `source` is that file itself or a dataset folder; then `truth_file` names a
/// file of state_groundtruth_estimate0, or `auto` takes the first of data_recomputed.csv, data.csv,
/// data_pose.csv there. The recomputed truth goes first because where it exists the official one was found
/// wrong: EuRoC's V1_01_easy turns its body frame by 5.5 degrees. Errors (kInput): nothing there.
Result<std::string> FindTruth(const std::string& source, const std::string& truth_file);

/// The rows without a gap above max_gap_s: all of them, or with a gap the longest such stretch
/// (TruthGaps::kLongestSpan; the first of equals) or an error (kRefuse). Precondition: stamps increase.
/// Errors (kInput) give the number of gaps and name the keys.
Result<Trajectory> KeepGapFree(const Trajectory& recorded, double max_gap_s, TruthGaps policy);

/// Reads the poses of `source`, keeps a gap-free stretch of at most duration_s, and fits a spline with knots
/// every knot_spacing_s. A truth with covariances (alidade refine_truth) obeys its IMU at every pose and has
/// a knot at every pose instead. Errors: those of FindTruth, ReadTrajectory, KeepGapFree and
/// SplineTrajectory::Fit, and a stretch shorter than a second; all kInput, naming the file.
Result<RecordedMotion> LoadRecordedMotion(const std::string& source, const SimulatorConfig& config);

}  // namespace alidade
