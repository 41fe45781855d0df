#include "eval/simulation/spline_trajectory.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <string>

namespace alidade {
namespace {

constexpr int kDegree = 5;
constexpr int kWeights = kDegree + 1;
// The motion goes on this far beyond its samples: a camera with a time offset looks there.
constexpr double kMarginSeconds = 0.5;
// Weight of a squared second difference of control points against a squared residual: decides where no sample
// does, and elsewhere moves the spline by far less than any sample's noise.
constexpr double kEvenness = 1e-6;
// Weight of the second (rotation) or third (position) difference at either end. The outermost control point
// counts for 1/120 at most and only at the very end: held by that alone it would swing by radians, and the
// fit of a real flight would not settle. Tied to its neighbours it moves the spline by 1/120 of that
// difference. Rotation takes the lower order because it must settle even where the recording ends with a hard
// landing.
constexpr double kEndStiffness = 1e-2;
constexpr int kMaxIterations = 100;
constexpr double kSettledRadians = 1e-9;

using Weights = std::array<double, kWeights>;

/// Basis of degree `degree` over one segment at x, for the control points i .. i + degree (Cox, de Boor; even
/// knots).
Weights BasisOfDegree(int degree, double x) {
  Weights basis{};
  basis[0] = 1;
  for (int p = 1; p <= degree; ++p) {
    for (int j = p; j >= 0; --j) {
      const auto index = static_cast<std::size_t>(j);
      const double rising = j > 0 ? (x + p - j) / p * basis[index - 1] : 0;
      const double falling = j < p ? (1 + j - x) / p * basis[index] : 0;
      basis[index] = rising + falling;
    }
  }
  return basis;
}

/// From the basis one degree lower, the derivative with respect to x.
Weights Difference(const Weights& lower) {
  Weights result{};
  for (std::size_t j = 0; j < kWeights; ++j) {
    result[j] = (j > 0 ? lower[j - 1] : 0) - lower[j];
  }
  return result;
}

struct Basis {
  Weights value = {};
  Weights first = {};   ///< d / dx
  Weights second = {};  ///< d^2 / dx^2

  explicit Basis(double x)
      : value(BasisOfDegree(kDegree, x)),
        first(Difference(BasisOfDegree(kDegree - 1, x))),
        second(Difference(Difference(BasisOfDegree(kDegree - 2, x)))) {}
};

/// Where on the spline an instant lies.
struct Place {
  std::size_t segment = 0;
  double x = 0;
};

Place Locate(double time_s, double spacing_s, std::size_t control_count) {
  const double last_segment = static_cast<double>(control_count - kWeights);
  const double position = std::clamp(time_s / spacing_s, 0.0, last_segment + 1);
  const double segment = std::min(std::floor(position), last_segment);
  return {static_cast<std::size_t>(segment), position - segment};
}

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

/// The normal matrix of a least-squares fit of spline coefficients, and the product of its right-hand side.
/// Position and rotation have the same form: both residuals are sum_j b_j(x) (change of control point i + j)
/// to first order.
class SplineTrajectory::NormalEquations {
 public:
  NormalEquations(std::size_t control_count, int end_order)
      : right_(Eigen::MatrixXd::Zero(Count(control_count), 3)) {
    for (std::size_t i = 0; i + 2 < control_count; ++i) {
      wishes_.push_back({i, {1, -2, 1, 0}, 3, kEvenness});
    }
    if (end_order == 2) {
      wishes_.push_back({0, {1, -2, 1, 0}, 3, kEndStiffness});
      wishes_.push_back({control_count - 3, {1, -2, 1, 0}, 3, kEndStiffness});
    } else {
      wishes_.push_back({0, {-1, 3, -3, 1}, 4, kEndStiffness});
      wishes_.push_back({control_count - 4, {-1, 3, -3, 1}, 4, kEndStiffness});
    }
    for (const Wish& wish : wishes_) {
      const Eigen::Index i = Count(wish.first);
      for (std::size_t a = 0; a < wish.count; ++a) {
        for (std::size_t b = 0; b < wish.count; ++b) {
          entries_.emplace_back(i + Count(a), i + Count(b),
                                wish.weight * wish.difference[a] * wish.difference[b]);
        }
      }
    }
  }

  void AddRow(const Place& place, const Weights& weights) {
    const Eigen::Index i = Count(place.segment);
    for (int a = 0; a < kWeights; ++a) {
      for (int b = 0; b < kWeights; ++b) {
        entries_.emplace_back(i + a, i + b,
                              weights[static_cast<std::size_t>(a)] * weights[static_cast<std::size_t>(b)]);
      }
    }
  }

  bool Factorize() {
    Eigen::SparseMatrix<double> matrix(right_.rows(), right_.rows());
    matrix.setFromTriplets(entries_.begin(), entries_.end());
    entries_.clear();
    solver_.compute(matrix);
    return solver_.info() == Eigen::Success;
  }

  void ClearRight() { right_.setZero(); }

  void AddRight(const Place& place, const Weights& weights, const Eigen::Vector3d& residual) {
    for (int a = 0; a < kWeights; ++a) {
      right_.row(Count(place.segment) + a) += weights[static_cast<std::size_t>(a)] * residual.transpose();
    }
  }

  /// The wishes pull on control points that exist already; `steps` are the steps from one control point to
  /// the next (for rotations their logarithms in W).
  void AddWishes(const std::vector<Eigen::Vector3d>& steps) {
    for (const Wish& wish : wishes_) {
      // A difference of control points is one order less of steps: its coefficients are the sums so far.
      Eigen::Vector3d difference = Eigen::Vector3d::Zero();
      double sum = 0;
      for (std::size_t a = 0; a + 1 < wish.count; ++a) {
        sum -= wish.difference[a];
        difference += sum * steps[wish.first + a];
      }
      for (std::size_t a = 0; a < wish.count; ++a) {
        right_.row(Count(wish.first + a)) -= wish.weight * wish.difference[a] * difference.transpose();
      }
    }
  }

  [[nodiscard]] Eigen::MatrixXd Solve() const { return solver_.solve(right_); }

 private:
  static Eigen::Index Count(std::size_t value) { return static_cast<Eigen::Index>(value); }

  /// A difference of neighbouring control points that should be small.
  struct Wish {
    std::size_t first = 0;
    std::array<double, 4> difference = {};
    std::size_t count = 0;  ///< of coefficients in use
    double weight = 0;
  };

  std::vector<Wish> wishes_;
  std::vector<Eigen::Triplet<double>> entries_;
  Eigen::MatrixXd right_;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver_;
};

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
  const std::size_t count = static_cast<std::size_t>(std::llround(duration_s_ / spacing_s_)) + kDegree;
  positions_.reserve(count);
  rotations_.reserve(count);
  std::size_t next = 0;
  for (std::size_t i = 0; i < count; ++i) {
    // The weight of control point i peaks here.
    const double centre_s = (static_cast<double>(i) - 0.5 * (kDegree - 1)) * spacing_s_;
    const TimeNs centre_ns = start_ns_ + SecondsToNs(centre_s);
    while (next + 1 < samples.points.size() && samples.points[next].stamp_ns < centre_ns) {
      ++next;
    }
    positions_.push_back(samples.points[next].nav.p_WB);
    rotations_.push_back(so3::Normalize(samples.points[next].nav.R_WB));
  }
}

Status SplineTrajectory::Solve(const Trajectory& samples) {
  NormalEquations position(positions_.size(), 3);
  NormalEquations rotation(rotations_.size(), 2);
  for (NormalEquations* equations : {&position, &rotation}) {
    for (const TrajectoryPoint& point : samples.points) {
      const Place place = Locate(SecondsBetween(start_ns_, point.stamp_ns), spacing_s_, positions_.size());
      equations->AddRow(place, Basis(place.x).value);
    }
    if (!equations->Factorize()) {
      return Status::Input("spline: the samples do not determine the control points");
    }
  }
  SolvePosition(samples, &position);
  return SolveRotation(samples, &rotation);
}

void SplineTrajectory::SolvePosition(const Trajectory& samples, NormalEquations* equations) {
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
      const Place place = Locate(time_s, spacing_s_, positions_.size());
      equations->AddRight(place, Basis(place.x).value, point.nav.p_WB - At(time_s).nav.p_WB);
    }
    const Eigen::MatrixXd step = equations->Solve();
    for (std::size_t i = 0; i < positions_.size(); ++i) {
      positions_[i] += step.row(static_cast<Eigen::Index>(i)).transpose();
    }
  }
}

Status SplineTrajectory::SolveRotation(const Trajectory& samples, NormalEquations* equations) {
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
      const Place place = Locate(time_s, spacing_s_, positions_.size());
      // A common turn of all control points in W turns the spline by just as much: the Jacobian is b_j to
      // first order in the turn between neighbours, and the steps below contract by that much each.
      equations->AddRight(place, Basis(place.x).value,
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
  const Place place = Locate(time_s, spacing_s_, positions_.size());
  const Basis basis(place.x);
  const double rate = 1 / spacing_s_;
  Kinematics motion;
  for (std::size_t j = 0; j < kWeights; ++j) {
    const Eigen::Vector3d& control = positions_[place.segment + j];
    motion.nav.p_WB += basis.value[j] * control;
    motion.nav.v_WB += rate * basis.first[j] * control;
    motion.acceleration_W += rate * rate * basis.second[j] * control;
  }
  motion.nav.R_WB = rotations_[place.segment];
  double sum = 1;
  double sum_first = 0;
  for (std::size_t j = 1; j < kWeights; ++j) {
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
