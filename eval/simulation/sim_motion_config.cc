#include "eval/simulation/sim_motion_config.h"

namespace alidade {
namespace {

void DescribePath(SimMotionConfig* config, ConfigVisitor& visitor) {
  visitor.Enumeration(
      {"trajectory", "-",
       "figure8 turns both ways, ellipse one way; wander does not repeat; hover holds its place; rotation "
       "only turns; line is straight; spiral is a helix; file is a recorded trajectory"},
      &config->trajectory,
      {{"figure8", SimTrajectory::kFigureEight},
       {"ellipse", SimTrajectory::kEllipse},
       {"wander", SimTrajectory::kWander},
       {"hover", SimTrajectory::kHover},
       {"rotation", SimTrajectory::kRotation},
       {"line", SimTrajectory::kLine},
       {"spiral", SimTrajectory::kSpiral},
       {"file", SimTrajectory::kFile}});
  visitor.Real(
      {"duration_s", "s",
       "200 s is the duration of the paper's simulation; largest duration taken from a recorded trajectory"},
      &config->duration_s, 1, 1e5);
  visitor.Real({"length_m", "m",
                "extent of the path along x; first diameter of a spiral; unused by rotation and line"},
               &config->length_m, 0.1, 1e5);
  visitor.Real({"width_m", "m", "extent of the path along y; unused by rotation, line and spiral"},
               &config->width_m, 0.1, 1e5);
  visitor.Real({"height_m", "m",
                "amplitude of the vertical motion, three periods a lap; 0 is planar; unused by rotation, "
                "line and spiral"},
               &config->height_m, 0, 1e4);
  visitor.Real(
      {"path_m", "m", "length of the path travelled in duration_s; sets the speed; unused by rotation"},
      &config->path_m, 0.1, 1e6);
  visitor.Enumeration(
      {"path_point", "-",
       "point of the rig that travels along the path, and stays fixed in rotation and pauses"},
      &config->path_point, {{"body", SimPathPoint::kBody}, {"camera", SimPathPoint::kCamera}});
  visitor.Real({"rotation_rate_radps", "rad/s", "root mean square of the yaw rate; trajectory rotation"},
               &config->rotation_rate_radps, 0.001, 10);
  visitor.Real({"spiral_widening_m", "m", "growth of the radius in each turn; trajectory spiral"},
               &config->spiral_widening_m, 0, 1e4);
  visitor.Real({"spiral_climb_m", "m", "growth of the height in each turn; trajectory spiral"},
               &config->spiral_climb_m, -1e4, 1e4);
}

/// Speed, rest, pauses and attitude along the path.
void DescribeTravel(SimMotionConfig* config, ConfigVisitor& visitor) {
  visitor.Real({"speed_variation", "-",
                "share by which the speed rises above and falls below its mean, as a sine; excites the "
                "accelerometer on a straight line"},
               &config->speed_variation, 0, 0.95);
  visitor.Real({"speed_period_s", "s", "period of these changes; unused without them"},
               &config->speed_period_s, 0.5, 1e4);
  visitor.Real(
      {"rest_s", "s", "at rest before the motion starts, for static initialisation; 0 starts in motion"},
      &config->rest_s, 0, 1e4);
  visitor.Real(
      {"rest_ramp_s", "s",
       "duration from rest to full speed, four times continuously differentiable; unused without rest and "
       "pauses"},
      &config->rest_ramp_s, 0.1, 100);
  visitor.Real({"pause_s", "s", "the path pauses for this long once every pause_period_s; 0: never"},
               &config->pause_s, 0, 1e4);
  visitor.Real({"pause_period_s", "s", "from one pause to the next, ramps included; unused without pauses"},
               &config->pause_period_s, 1, 1e5);
  visitor.Real({"pause_turn_rad", "rad", "yaw in each pause: pure rotation; 6.2832 is a full turn, 0 a rest"},
               &config->pause_turn_rad, -100, 100);
  visitor.Real({"yaw_rate_radps", "rad/s",
                "constant turn of the body besides the path's own, such as a slow one in hover"},
               &config->yaw_rate_radps, -10, 10);
  visitor.Real({"wobble_rad", "rad",
                "amplitude of roll, pitch and half of it in yaw about the path's tangent; excites all axes"},
               &config->wobble_rad, 0, 0.5);
  visitor.Real({"wobble_hz", "Hz", "frequency of the roll wobble; pitch and yaw use 0.77 and 0.61 of it"},
               &config->wobble_hz, 0, 10);
}

void DescribeRecording(SimMotionConfig* config, ConfigVisitor& visitor) {
  visitor.Text({"trajectory_file", "-",
                "for trajectory: file; a file of EuRoC, TUM or Alidade format, or a dataset folder; relative "
                "to this file"},
               &config->trajectory_file);
  visitor.Text(
      {"hybrid_dataset", "-",
       "dataset folder whose real IMU and calibration are used; only tracks are simulated; required: a "
       "setting must name it"},
      &config->hybrid_dataset);
  visitor.Text(
      {"truth_file", "-",
       "truth file of a dataset folder; auto: data_recomputed.csv, else data.csv, else data_pose.csv"},
      &config->truth_file);
  visitor.Real(
      {"knot_spacing_s", "s",
       "knot spacing of the spline through a recorded trajectory; a shorter one follows faster "
       "motion and more noise; a truth with covariances (refine_truth) has a knot at every pose instead"},
      &config->knot_spacing_s, 0.01, 10);
  visitor.Real(
      {"max_gap_s", "s",
       "a longer interval without poses of a recorded trajectory is a gap, in which the motion is unknown"},
      &config->max_gap_s, 0.001, 100);
  visitor.Enumeration(
      {"truth_gaps", "-", "longest_span uses the longest stretch without a gap, refuse makes gaps an error"},
      &config->truth_gaps, {{"longest_span", TruthGaps::kLongestSpan}, {"refuse", TruthGaps::kRefuse}});
}

}  // namespace

void SimMotionConfig::DescribeMotion(ConfigVisitor& visitor) {
  DescribePath(this, visitor);
  DescribeTravel(this, visitor);
  DescribeRecording(this, visitor);
}

}  // namespace alidade
