#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/status.h"
#include "eval/simulation/continuous_trajectory.h"
#include "eval/simulation/spline_equations.h"
#include "eval/trajectory/trajectory.h"

namespace alidade {

/// How far a spline lies from the trajectory it was fitted to.
struct SplineFit {
  double position_rms_m = 0;
  double position_max_m = 0;
  double rotation_rms_rad = 0;
  double rotation_max_rad = 0;
  double max_gap_s = 0;  ///< longest silence of the samples; the spline invents the motion there
};

/// A recorded trajectory (for instance the ground truth of a flight) as a smooth motion: uniform B-splines of
/// degree 5 in R^3 for the position and, cumulative, in SO(3) for the rotation, so that acceleration and
/// angular rate are exact derivatives and themselves three times continuously differentiable. With x = (t -
/// t_i) / dt in [0, 1) and the cumulative basis l_j(x),
///
///   p(t) = sum_j b_j(x) p_{i+j},    R(t) = R_i prod_{j=1..5} Exp(l_j(x) d_j),    d_j = Log(R_{i+j-1}^T
///   R_{i+j}), w_j = Exp(-l_j d_j) w_{j-1} + l_j'(x) / dt d_j,    w_0 = 0, w = w_5 (body frame)
///
/// (Kim, Kim, Shin 1995; Sommer et al., "Efficient derivative computation for cumulative B-splines on Lie
/// groups", 2020). Velocities in the trajectory are not used: they are the position's derivatives here.
class SplineTrajectory final : public ContinuousTrajectory {
 public:
  /// Least squares over all points, with a faint wish for even spacing that decides where there are none and
  /// a wish for little change of the motion at the very ends. Knots every `knot_spacing_s` (or a little
  /// closer, so that they divide the duration): shorter follows faster motion and more of the samples' noise;
  /// 0.1 s suits hand-held and flown truth. Time 0 is the first point. Errors (kInput): fewer than two
  /// points, a spacing that is not positive, a trajectory shorter than the spacing, stamps out of order, a
  /// number that is not finite, a rotation that turns too fast for the spacing (the fit does not settle).
  static Result<SplineTrajectory> Fit(const Trajectory& samples, double knot_spacing_s);

  /// Outside the samples, up to half a second, velocity and angular rate stay as at that end; farther out the
  /// body stands.
  [[nodiscard]] Kinematics At(double time_s) const override;
  [[nodiscard]] double DurationSeconds() const override { return duration_s_; }

  [[nodiscard]] TimeNs start_ns() const { return start_ns_; }
  [[nodiscard]] const SplineFit& fit() const { return fit_; }

 private:
  SplineTrajectory() = default;

  [[nodiscard]] Kinematics Inside(double time_s) const;
  void PlaceControlPoints(const Trajectory& samples);
  Status Solve(const Trajectory& samples);
  void SolvePosition(const Trajectory& samples, SplineEquations* equations);
  Status SolveRotation(const Trajectory& samples, SplineEquations* equations);
  void MeasureFit(const Trajectory& samples);

  TimeNs start_ns_ = 0;
  double duration_s_ = 0;
  double spacing_s_ = 0;
  std::vector<Eigen::Vector3d> positions_;  ///< control points p_i in W
  std::vector<Eigen::Matrix3d> rotations_;  ///< control points R_i = R_WB
  SplineFit fit_;
};

}  // namespace alidade
