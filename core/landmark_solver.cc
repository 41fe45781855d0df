#include "core/landmark_solver.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/reprojection.h"

namespace alidade {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kDecrementTolerance = 1e-14;  // of 1 + the cost
constexpr double kMinCurvature = 0.01;         // of the kernel's weight; positive, so that a step descends
constexpr double kFirstDamping = 1e-4;
constexpr double kMaxDamping = 1e8;

/// Normal equations of the landmark (x, y, rho).
struct LandmarkSystem {
  Matrix3d hessian = Matrix3d::Zero();
  Vector3d gradient = Vector3d::Zero();

  /// The two whitened rows of a view with squared residual s.
  void Add(const PointRows<2>& jacobian, const Vector2d& residual, double s,
           const ObservationKernel& kernel) {
    const double weight = kernel.Weight(s);
    const Vector3d slope = jacobian.transpose() * residual;
    gradient += weight * slope;
    // Newton's curvature of the kernel, along the residual; plain re-weighting converges linearly only.
    const double curvature = std::max(kernel.RadialCurvature(s), kMinCurvature * weight);
    if (curvature < weight) {
      hessian += weight * jacobian.transpose() * jacobian -
                 (weight - curvature) / std::max(s, 1e-300) * slope * slope.transpose();
    } else {
      hessian += weight * jacobian.transpose() * jacobian;
    }
  }
};

/// LandmarkCost; adds to `system` when given.
double Evaluate(std::span<const Pose> T_WC, std::span<const NormalizedObservation> observations,
                const LandmarkOptions& options, const Vector3d& landmark, LandmarkSystem* system) {
  if (options.finite_depth && !(landmark.z() > 0)) {
    return kInfinity;
  }
  const DepthPrior& prior = options.depth_prior;
  const double depth_residual = prior.sqrt_information * (landmark.z() - prior.mean);
  double cost = depth_residual * depth_residual;
  if (system != nullptr) {
    system->gradient.z() += prior.sqrt_information * depth_residual;
    system->hessian(2, 2) += prior.sqrt_information * prior.sqrt_information;
  }
  for (size_t k = 0; k < T_WC.size(); ++k) {
    const Eigen::Matrix2d& whitening = observations[k].sqrt_information;
    const AnchoredPointInCamera seen(T_WC.front(), T_WC[k], landmark, observations.front().plane);
    Vector2d predicted;
    PointRows<2> projection;
    if (!ProjectToPlane(observations[k].plane, seen.q, kMinScaledDepth, &predicted,
                        system != nullptr ? &projection : nullptr)) {
      return kInfinity;
    }
    const Vector2d residual = whitening * (predicted - observations[k].z);
    const double s = residual.squaredNorm();
    cost += options.kernel.Rho(s);
    if (system != nullptr) {
      const PointRows<2> over_q = whitening * projection;
      PointRows<2> jacobian;
      seen.Chain(over_q, nullptr, nullptr, &jacobian);
      system->Add(jacobian, residual, s, options.kernel);
    }
  }
  return cost;
}

}  // namespace

bool TriangulateLandmark(std::span<const Pose> T_WC, std::span<const NormalizedObservation> observations,
                         DepthViews views, double max_relative_deviation, PoseOnlyDepth* depth) {
  if (!ComputePoseOnlyDepth(T_WC, observations, 0, views, depth)) {
    return false;
  }
  const int other_views = views == DepthViews::kTwo ? 1 : static_cast<int>(T_WC.size()) - 1;
  return DepthIsDetermined(*depth, other_views, observations.back().deviation(), max_relative_deviation);
}

double LandmarkCost(std::span<const Pose> T_WC, std::span<const NormalizedObservation> observations,
                    const LandmarkOptions& options, const Vector3d& landmark) {
  return Evaluate(T_WC, observations, options, landmark, nullptr);
}

bool SolveLandmark(std::span<const Pose> T_WC, std::span<const NormalizedObservation> observations,
                   const LandmarkOptions& options, Vector3d* landmark, double* least) {
  LandmarkSystem system;
  double cost = Evaluate(T_WC, observations, options, *landmark, &system);
  double damping = 0;
  for (int i = 0; i < options.max_iterations && std::isfinite(cost); ++i) {
    Matrix3d damped = system.hessian;
    damped.diagonal() *= 1 + damping;
    const Vector3d step = -damped.llt().solve(system.gradient);
    const double decrement = -step.dot(system.gradient);
    if (!(decrement > kDecrementTolerance * (1 + cost))) {
      break;
    }
    LandmarkSystem next;
    const Vector3d candidate = *landmark + step;
    const double candidate_cost = Evaluate(T_WC, observations, options, candidate, &next);
    if (candidate_cost <= cost * (1 + 1e-15)) {
      *landmark = candidate;
      cost = candidate_cost;
      system = next;
      damping = damping < 1e-6 ? 0 : damping * 0.1;
    } else {
      damping = std::max(damping * 100, kFirstDamping);
      if (damping > kMaxDamping) {
        break;
      }
    }
  }
  if (least != nullptr) {
    *least = cost;
  }
  return std::isfinite(cost) && landmark->allFinite();
}

bool RefineLandmark(std::span<const Pose> T_WC, std::span<const NormalizedObservation> observations,
                    int max_iterations, Vector3d* p_W) {
  const Pose& base = T_WC.front();
  const BearingPlane& plane = observations.front().plane;
  const Vector3d p_base = plane.InAxes(PointInCamera(base, *p_W).q);
  if (!(p_base.z() > kMinPointDepth)) {
    return false;
  }
  Vector3d landmark(p_base.x() / p_base.z(), p_base.y() / p_base.z(), 1 / p_base.z());
  LandmarkOptions options;
  options.max_iterations = max_iterations;
  options.finite_depth = true;
  if (!SolveLandmark(T_WC, observations, options, &landmark)) {
    return false;
  }
  *p_W = base * Vector3d(plane.Direction(landmark.head<2>()) / landmark.z());
  return true;
}

}  // namespace alidade
