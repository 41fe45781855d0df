#pragma once

#include <string>
#include <string_view>

#include "core/config_schema.h"

namespace alidade {

enum class SimTrajectory { kFigureEight, kEllipse, kWander, kHover, kRotation, kLine, kSpiral, kFile };
/// The point of the rig that travels along the path.
enum class SimPathPoint { kBody, kCamera };
/// What to do with a recorded trajectory that has gaps: the motion in a gap is unknown.
enum class TruthGaps {
  kLongestSpan,  ///< use the longest stretch without a gap
  kRefuse,
};

/// Value of a path that is not given.
inline constexpr std::string_view kNoPath = "none";
/// Value of a path that a setting must give: a config for many sequences is refused without it.
inline constexpr std::string_view kRequiredPath = "required";

/// The part of a simulation about the motion, analytic (eval/simulation/sim_trajectory.h) or recorded.
struct SimMotionConfig {
  SimTrajectory trajectory = SimTrajectory::kFigureEight;
  double duration_s = 200;
  double length_m = 10;   ///< extent along x
  double width_m = 5;     ///< extent along y
  double height_m = 0.5;  ///< amplitude of the vertical motion
  double path_m = 262;    ///< total path length; sets the speed
  SimPathPoint path_point = SimPathPoint::kBody;
  double rotation_rate_radps = 0.5;  ///< root mean square of the yaw rate of `rotation`
  double spiral_widening_m = 0;      ///< growth of the radius in a turn
  double spiral_climb_m = 1;         ///< growth of the height in a turn
  double speed_variation = 0;        ///< share of the mean speed by which it rises and falls
  double speed_period_s = 10;
  double rest_s = 0;       ///< at rest before the motion starts (smoothly)
  double rest_ramp_s = 2;  ///< from rest to full speed; no effect without rest and pauses
  double pause_s = 0;      ///< at rest but for a turn, once every pause_period_s; 0: never
  double pause_period_s = 30;
  double pause_turn_rad = 0;  ///< yaw in each pause
  double yaw_rate_radps = 0;  ///< constant turn besides that of the path
  double wobble_rad = 0.05;   ///< amplitude of the attitude about the path's tangent
  double wobble_hz = 0.3;

  std::string trajectory_file = std::string(kNoPath);  ///< for kFile: a trajectory or a dataset folder
  std::string hybrid_dataset = std::string(kNoPath);   ///< dataset folder whose IMU and calibration are used
  std::string truth_file = "auto";                     ///< which truth of a dataset folder
  double knot_spacing_s = 0.1;                         ///< of the spline through a recorded trajectory
  double max_gap_s = 0.2;                              ///< longer silences of a recorded trajectory are gaps
  TruthGaps truth_gaps = TruthGaps::kLongestSpan;

  void DescribeMotion(ConfigVisitor& visitor);
};

}  // namespace alidade
