#include "eval/simulation/spline_trajectory.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "eval/simulation/spline_basis.h"

namespace alidade {
namespace {

// The motion goes on this far beyond its samples: a camera with a time offset looks there.
constexpr double kMarginSeconds = 0.5;
constexpr int kMaxIterations = 100;
constexpr double kSettledRadians = 1e-9;

Status CheckSamples(const Trajectory& samples, double spacing_s) {
  if (!(spacing_s > 0) || !std::isfinite(spacing_s)) {
    return Status::Input("spline: knot spacing " + std::to_string(spacing_s) +
                         " s; expected a positive number");
  }
  if (samples.points.size() < 2) {
    return Status::Input("spline: " + std::to_string(samples.points.size()) +
                         " samples; expected at least 2");
  }
  for (std::size_t k = 0; k < samples.points.size(); ++k) {
    const TrajectoryPoint& point = samples.points[k];
    if (!point.nav.p_WB.allFinite() || !point.nav.R_WB.allFinite()) {
      return Status::Input("spline: sample at " + FormatSeconds(point.stamp_ns) + " is not finite");
    }
    if (k > 0 && point.stamp_ns <= samples.points[k - 1].stamp_ns) {
      return Status::Input("spline: sample at " + FormatSeconds(point.stamp_ns) +
                           "; expected a stamp later than " + FormatSeconds(samples.points[k - 1].stamp_ns));
    }
  }
  if (SecondsBetween(samples.points.front().stamp_ns, samples.points.back().stamp_ns) < spacing_s) {
    return Status::Input("spline: the samples are shorter than the knot spacing");
  }
  return Status::Ok();
}

}  // namespace

Result<SplineTrajectory> SplineTrajectory::Fit(const Trajectory& samples, double knot_spacing_s) {
  ALIDADE_RETURN_IF_ERROR(CheckSamples(samples, knot_spacing_s));
  SplineTrajectory spline;
  spline.start_ns_ = samples.points.front().stamp_ns;
  spline.duration_s_ = SecondsBetween(spline.start_ns_, samples.points.back().stamp_ns);
  // Whole segments: a last one with few samples would hardly hold its control point.
  spline.spacing_s_ = spline.duration_s_ / std::ceil(spline.duration_s_ / knot_spacing_s - 1e-6);
  spline.PlaceControlPoints(samples);
  ALIDADE_RETURN_IF_ERROR(spline.Solve(samples));
  spline.MeasureFit(samples);
  return spline;
}

void SplineTrajectory::PlaceControlPoints(const Trajectory& samples) {
  const std::size_t count = static_cast<std::size_t>(std::llround(duration_s_ / spacing_s_)) + kSplineDegree;
  positions_.reserve(count);
  rotations_.reserve(count);
  std::size_t next = 0;
  for (std::size_t i = 0; i < count; ++i) {
    // The weight of control point i peaks here.
    const double centre_s = (static_cast<double>(i) - 0.5 * (kSplineDegree - 1)) * spacing_s_;
    const TimeNs centre_ns = start_ns_ + SecondsToNs(centre_s);
    while (next + 1 < samples.points.size() && samples.points[next].stamp_ns < centre_ns) {
      ++next;
    }
    positions_.push_back(samples.points[next].nav.p_WB);
    rotations_.push_back(so3::Normalize(samples.points[next].nav.R_WB));
  }
}

Status SplineTrajectory::Solve(const Trajectory& samples) {
  SplineEquations position(positions_.size(), 3);
  SplineEquations rotation(rotations_.size(), 2);
  for (SplineEquations* equations : {&position, &rotation}) {
    for (const TrajectoryPoint& point : samples.points) {
      const SplinePlace place =
          LocateOnSpline(SecondsBetween(start_ns_, point.stamp_ns), spacing_s_, positions_.size());
      equations->AddRow(place, SplineBasis(place.x).value);
    }
    if (!equations->Factorize()) {
      return Status::Input("spline: the samples do not determine the control points");
    }
  }
  SolvePosition(samples, &position);
  return SolveRotation(samples, &rotation);
}

void SplineTrajectory::SolvePosition(const Trajectory& samples, SplineEquations* equations) {
  // The position is linear: one step, and one more takes off the rounding of the first.
  for (int iteration = 0; iteration < 2; ++iteration) {
    equations->ClearRight();
    std::vector<Eigen::Vector3d> steps;
    for (std::size_t i = 1; i < positions_.size(); ++i) {
      steps.emplace_back(positions_[i] - positions_[i - 1]);
    }
    equations->AddWishes(steps);
    for (const TrajectoryPoint& point : samples.points) {
      const double time_s = SecondsBetween(start_ns_, point.stamp_ns);
      const SplinePlace place = LocateOnSpline(time_s, spacing_s_, positions_.size());
      equations->AddRight(place, SplineBasis(place.x).value, point.nav.p_WB - At(time_s).nav.p_WB);
    }
    const Eigen::MatrixXd step = equations->Solve();
    for (std::size_t i = 0; i < positions_.size(); ++i) {
      positions_[i] += step.row(static_cast<Eigen::Index>(i)).transpose();
    }
  }
}

Status SplineTrajectory::SolveRotation(const Trajectory& samples, SplineEquations* equations) {
  double largest_step_rad = 0;
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    equations->ClearRight();
    std::vector<Eigen::Vector3d> turns;
    for (std::size_t i = 1; i < rotations_.size(); ++i) {
      turns.push_back(so3::Log(rotations_[i] * rotations_[i - 1].transpose()));
    }
    equations->AddWishes(turns);
    for (const TrajectoryPoint& point : samples.points) {
      const double time_s = SecondsBetween(start_ns_, point.stamp_ns);
      const SplinePlace place = LocateOnSpline(time_s, spacing_s_, positions_.size());
      // A common turn of all control points in W turns the spline by just as much: the Jacobian is b_j to
      // first order in the turn between neighbours, and the steps below contract by that much each.
      equations->AddRight(place, SplineBasis(place.x).value,
                          so3::Log(point.nav.R_WB * At(time_s).nav.R_WB.transpose()));
    }
    const Eigen::MatrixXd step = equations->Solve();
    for (std::size_t i = 0; i < rotations_.size(); ++i) {
      const Eigen::Vector3d turn = step.row(static_cast<Eigen::Index>(i)).transpose();
      rotations_[i] = so3::Normalize(so3::Exp(turn) * rotations_[i]);
    }
    largest_step_rad = step.cwiseAbs().maxCoeff();
    if (largest_step_rad < kSettledRadians) {
      return Status::Ok();
    }
  }
  return Status::Input("spline: the rotation does not converge with knots every " +
                       std::to_string(spacing_s_) + " s (last step " + std::to_string(largest_step_rad) +
                       " rad); expected a shorter spacing");
}

Kinematics SplineTrajectory::At(double time_s) const {
  const double inside_s = std::clamp(time_s, 0.0, duration_s_);
  Kinematics motion = Inside(inside_s);
  const double beyond_s = time_s - inside_s;
  if (beyond_s != 0) {
    const double even_s = std::clamp(beyond_s, -kMarginSeconds, kMarginSeconds);
    motion.nav.p_WB += even_s * motion.nav.v_WB;
    motion.nav.R_WB = motion.nav.R_WB * so3::Exp(even_s * motion.angular_rate_B);
    motion.acceleration_W.setZero();
    if (even_s != beyond_s) {
      motion.nav.v_WB.setZero();
      motion.angular_rate_B.setZero();
    }
  }
  return motion;
}

Kinematics SplineTrajectory::Inside(double time_s) const {
  const SplinePlace place = LocateOnSpline(time_s, spacing_s_, positions_.size());
  const SplineBasis basis(place.x);
  const double rate = 1 / spacing_s_;
  Kinematics motion;
  for (std::size_t j = 0; j < kSplineWeights; ++j) {
    const Eigen::Vector3d& control = positions_[place.segment + j];
    motion.nav.p_WB += basis.value[j] * control;
    motion.nav.v_WB += rate * basis.first[j] * control;
    motion.acceleration_W += rate * rate * basis.second[j] * control;
  }
  motion.nav.R_WB = rotations_[place.segment];
  double sum = 1;
  double sum_first = 0;
  for (std::size_t j = 1; j < kSplineWeights; ++j) {
    // Cumulative basis: what is left of the partition of unity after the first j weights.
    sum -= basis.value[j - 1];
    sum_first -= basis.first[j - 1];
    const Eigen::Vector3d turn =
        so3::Log(rotations_[place.segment + j - 1].transpose() * rotations_[place.segment + j]);
    const Eigen::Matrix3d step = so3::Exp(sum * turn);
    motion.nav.R_WB = motion.nav.R_WB * step;
    motion.angular_rate_B = step.transpose() * motion.angular_rate_B + rate * sum_first * turn;
  }
  return motion;
}

void SplineTrajectory::MeasureFit(const Trajectory& samples) {
  double position2 = 0;
  double rotation2 = 0;
  for (std::size_t k = 0; k < samples.points.size(); ++k) {
    const TrajectoryPoint& point = samples.points[k];
    const NavState here = At(SecondsBetween(start_ns_, point.stamp_ns)).nav;
    const double position_m = (point.nav.p_WB - here.p_WB).norm();
    const double rotation_rad = so3::Log(here.R_WB.transpose() * point.nav.R_WB).norm();
    position2 += position_m * position_m;
    rotation2 += rotation_rad * rotation_rad;
    fit_.position_max_m = std::max(fit_.position_max_m, position_m);
    fit_.rotation_max_rad = std::max(fit_.rotation_max_rad, rotation_rad);
    if (k > 0) {
      fit_.max_gap_s =
          std::max(fit_.max_gap_s, SecondsBetween(samples.points[k - 1].stamp_ns, point.stamp_ns));
    }
  }
  const double count = static_cast<double>(samples.points.size());
  fit_.position_rms_m = std::sqrt(position2 / count);
  fit_.rotation_rms_rad = std::sqrt(rotation2 / count);
}

}  // namespace alidade
