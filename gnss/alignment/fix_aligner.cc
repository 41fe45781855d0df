#include "gnss/alignment/fix_aligner.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/dense_solvers.h"
#include "core/format.h"
#include "core/median.h"
#include "core/robust.h"

namespace alidade {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Vector7d = Eigen::Matrix<double, 7, 1>;
using Matrix7d = Eigen::Matrix<double, 7, 7>;

constexpr std::size_t kMaxPoints = 40;  // bounds the pairs
constexpr double kFixRetryS = 0.5;
constexpr int kRows = PositionFixModel::kRows;

}  // namespace

/// Of yaw, shift and velocity's correction, Gauss-Newton.
struct FixAligner::Normal {
  Matrix7d hessian = Matrix7d::Zero();
  Vector7d gradient = Vector7d::Zero();
  int inside = 0;    ///< points inside the gate
  double scale = 1;  ///< robust deviation of the whitened residuals
};

struct FixAligner::Fit {
  bool ok = false;
  FixGuess guess;
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();  ///< of yaw and shift
  int inside = 0;                                        ///< points inside the gate
  double scale = 1;                                      ///< robust deviation of the whitened residuals
};

FixAligner::FixAligner(const FixConfig& config, std::vector<FixSensor> sensors,
                       const std::optional<EnuFrame>& enu)
    : config_(config), sensors_(std::move(sensors)), enu_(enu), matcher_(config.align_window_s) {}

void FixAligner::AddState(const NavEstimate& estimate) {
  AlignmentState state;
  state.stamp_ns = estimate.stamp_ns;
  state.nav = estimate.nav;
  state.bias = estimate.bias;
  state.velocity_covariance_W = estimate.covariance.block<3, 3>(6, 6);
  state.position_covariance_W = estimate.covariance.block<3, 3>(3, 3);
  matcher_.AddState(std::move(state));
  MatchFixes();
}

void FixAligner::AddFix(const PositionFix& fix) {
  matcher_.AddMessage(fix);
  MatchFixes();
}

void FixAligner::ForgetEstimate() {
  matcher_.ForgetStates();
  samples_.clear();
}

void FixAligner::MatchFixes() {
  while (const std::optional<StateMatcher<PositionFix>::Match> match = matcher_.Next()) {
    const PositionFix& fix = match->message;
    const Vector3d& p_BA = sensors_[static_cast<std::size_t>(fix.sensor)].p_BA;
    const Result<FixMeasurement> measurement = MakeFixMeasurement(config_, p_BA, fix);
    if (measurement.ok()) {
      samples_.push_back({match->state, *measurement, measurement->model.Predict(match->state.nav)});
    }
  }
  const StateHistory& states = matcher_.states();
  while (!samples_.empty() && !states.empty() &&
         SecondsBetween(samples_.front().state.stamp_ns, states.newest().stamp_ns) > config_.align_window_s) {
    samples_.pop_front();
  }
}

std::vector<FixPoint> FixAligner::Points() const {
  const std::size_t step = (samples_.size() + kMaxPoints - 1) / kMaxPoints;
  const AlignmentState& newest = samples_.back().state;
  std::vector<FixPoint> points;
  for (std::size_t i = (samples_.size() - 1) % step; i < samples_.size(); i += step) {
    const Sample& sample = samples_[i];
    const Matrix3d& root = sample.fix.sqrt_information;
    const double drift = (newest.position_covariance_W - sample.state.position_covariance_W).trace() / 3;
    const Matrix3d covariance =
        (root.transpose() * root).inverse() + std::max(drift, 0.0) * Matrix3d::Identity();
    points.push_back({sample.p_WA, sample.fix.model.p_WA,
                      SecondsBetween(newest.stamp_ns, sample.state.stamp_ns), Whitener(covariance),
                      sample.state.velocity_covariance_W.diagonal()});
  }
  return points;
}

/// Each pair of points determines yaw and shift; the pair counts whose residuals have the least median.
FixGuess FixAligner::FirstGuess(const std::vector<FixPoint>& points) {
  FixGuess best;
  double best_median = INFINITY;
  std::vector<double> squares(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t j = i + 1; j < points.size(); ++j) {
      const Vector3d chord_W = points[j].p_WA - points[i].p_WA;
      const Vector3d chord_N = points[j].p_NA - points[i].p_NA;
      FixGuess guess;
      YawShift& transform = guess.transform;
      transform.yaw_rad = std::atan2(chord_N.y(), chord_N.x()) - std::atan2(chord_W.y(), chord_W.x());
      transform.p_NW =
          0.5 * (points[i].p_NA + points[j].p_NA - transform.Rotation() * (points[i].p_WA + points[j].p_WA));
      for (std::size_t k = 0; k < points.size(); ++k) {
        squares[k] = guess.Residual(points[k]).squaredNorm();
      }
      const double median = Median(squares);
      if (median < best_median) {
        best_median = median;
        best = guess;
      }
    }
  }
  return best;
}

FixAligner::Normal FixAligner::NormalEquations(const std::vector<FixPoint>& points,
                                               const FixGuess& guess) const {
  constexpr double kHeld = 1e-9;     // of a velocity that is known
  constexpr double kAnyYawRad = 10;  // at rest no fix determines the yaw
  constexpr double kGateScales = 3.5;
  const double gate = std::sqrt(ChiSquareQuantile(kRows, config_.gate_probability));
  const double median_norm = std::sqrt(ChiSquareQuantile(kRows, 0.5));  // of a residual of deviation 1
  std::vector<double> norms;
  norms.reserve(points.size());
  for (const FixPoint& point : points) {
    norms.push_back(guess.Residual(point).norm());
  }
  Normal normal;
  normal.scale = std::max(1.0, Median(norms) / median_norm);
  Vector3d velocity_variance = Vector3d::Zero();
  for (std::size_t k = 0; k < points.size(); ++k) {
    const FixPoint& point = points[k];
    velocity_variance += point.velocity_variance_W / static_cast<double>(points.size());
    if (norms[k] > std::max(gate, kGateScales * median_norm * normal.scale)) {
      continue;
    }
    ++normal.inside;
    const Eigen::Matrix<double, kRows, 7> jacobian = guess.Jacobian(point);
    const double weight =
        RobustWeight(config_.robust_kernel, config_.robust_scale_sigma * normal.scale, norms[k] * norms[k]);
    normal.hessian += weight * jacobian.transpose() * jacobian;
    normal.gradient += weight * jacobian.transpose() * guess.Residual(point);
  }
  normal.hessian(0, 0) += 1 / (kAnyYawRad * kAnyYawRad);
  for (int axis = 0; axis < 3; ++axis) {
    const double information = 1 / (std::max(velocity_variance[axis], 0.0) + kHeld * kHeld);
    normal.hessian(4 + axis, 4 + axis) += information;
    normal.gradient[4 + axis] += information * guess.dv_W[axis];
  }
  return normal;
}

FixAligner::Fit FixAligner::Refine(const std::vector<FixPoint>& points, FixGuess guess) const {
  constexpr int kIterations = 12;
  Fit fit;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    const Normal normal = NormalEquations(points, guess);
    fit.scale = normal.scale;
    fit.inside = normal.inside;
    const SymmetricSolver solver(normal.hessian);
    const Vector7d step = solver.Solve(-normal.gradient);
    if (!solver.positive() || !step.allFinite()) {
      return fit;
    }
    guess.Move(step);
    fit.covariance = solver.Solve(Eigen::Matrix<double, 7, 4>::Identity()).topRows<4>();
  }
  fit.guess = guess;
  fit.ok = true;
  return fit;
}

std::optional<GnssAlignment> FixAligner::TryAlign() {
  if (static_cast<int>(samples_.size()) < config_.align_min_fixes) {
    report_ =
        Format("%zu position fixes within the window, expected %d", samples_.size(), config_.align_min_fixes);
    return std::nullopt;
  }
  const TimeNs newest = samples_.back().state.stamp_ns;
  if (tried_ns_ != INT64_MIN && SecondsBetween(tried_ns_, newest) < kFixRetryS) {
    return std::nullopt;
  }
  tried_ns_ = newest;
  const std::vector<FixPoint> points = Points();
  const Fit fit = Refine(points, FirstGuess(points));
  if (!fit.ok) {
    report_ = "the position fixes do not determine the alignment";
    return std::nullopt;
  }
  return Accept(fit, points.size());
}

std::optional<GnssAlignment> FixAligner::Accept(const Fit& fit, std::size_t points) {
  const double inflation = config_.align_inflation * fit.scale;
  GnssAlignment alignment;
  alignment.covariance = inflation * inflation * 0.5 * (fit.covariance + fit.covariance.transpose());
  const double yaw_std = std::sqrt(alignment.covariance(0, 0));
  const TimeNs newest = samples_.back().state.stamp_ns;
  report_ =
      Format("%d of %zu position fixes over %.1f s agree: yaw to %.3f rad, position to %.3f m, scale %.2f",
             fit.inside, points, SecondsBetween(samples_.front().state.stamp_ns, newest), yaw_std,
             std::sqrt(alignment.covariance.bottomRightCorner<3, 3>().trace()), fit.scale);
  if (fit.inside < config_.align_min_fixes || 2 * static_cast<std::size_t>(fit.inside) <= points) {
    report_ += Format(", expected at least %d and more than half", config_.align_min_fixes);
    return std::nullopt;
  }
  if (!(yaw_std < config_.align_max_yaw_std_rad)) {
    report_ += Format(", expected below %.3f rad: too little motion", config_.align_max_yaw_std_rad);
    return std::nullopt;
  }
  alignment.stamp_ns = newest;
  alignment.enu = enu_;
  alignment.yaw_rad = fit.guess.transform.yaw_rad;
  alignment.p_NW = fit.guess.transform.p_NW;
  alignment.report = report_ + Format(", yaw %.4f rad", fit.guess.transform.yaw_rad);
  return alignment;
}

}  // namespace alidade
