#include <Eigen/Cholesky>
#include <cmath>
#include <limits>

#include "core/pose_only.h"
#include "core/robust.h"
#include "smoother/tracks/track_system.h"

// The landmark of a track, the poses held fixed.

namespace alidade {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Matrix2x3 = Eigen::Matrix<double, 2, 3>;

constexpr double kMinViewDepth = 1e-6;  // of the scaled point (x, y, 1) + rho t
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Normal equations of the landmark (x, y, rho) with poses fixed.
struct LandmarkSystem {
  Matrix3d hessian = Matrix3d::Zero();
  Vector3d gradient = Vector3d::Zero();
};

const FrameGeometry& Geometry(std::span<const FrameGeometry> geometry, const WindowView& view) {
  return geometry[static_cast<size_t>(view.frame->index)];
}

/// rho' + 2 s rho'': second derivative of the cost along the residual, kept positive so that a Newton step
/// descends.
double RadialCurvature(const ObservationKernel& kernel, double s, double weight) {
  const double k2 = kernel.scale_sigma * kernel.scale_sigma;
  double ratio = 1;
  if (kernel.kernel == RobustKernel::kHuber && s > k2) {
    ratio = 0;
  } else if (kernel.kernel == RobustKernel::kCauchy) {
    ratio = (k2 - s) / (k2 + s);
  }
  return weight * std::max(ratio, 0.01);
}

/// Robust cost (sum of rho) of the landmark; fills `system` when given. Infinite behind a view.
double EvaluateLandmark(std::span<const WindowView> views, std::span<const FrameGeometry> geometry,
                        const ObservationKernel& kernel, const Vector3d& landmark, const DepthPrior& prior,
                        LandmarkSystem* system) {
  const Pose& base = Geometry(geometry, views.front()).T_WC;
  const Vector3d ray_W = base.rotation * Vector3d(landmark.x(), landmark.y(), 1);
  const double depth_residual = prior.sqrt_information * (landmark.z() - prior.mean);
  double cost = depth_residual * depth_residual;
  if (system != nullptr) {
    system->gradient.z() += prior.sqrt_information * depth_residual;
    system->hessian(2, 2) += prior.sqrt_information * prior.sqrt_information;
  }
  for (const WindowView& view : views) {
    const Pose& T_WC = Geometry(geometry, view).T_WC;
    const Vector3d shift_W = base.translation - T_WC.translation;
    const Vector3d q = T_WC.rotation.transpose() * (ray_W + landmark.z() * shift_W);
    if (!(q.z() > kMinViewDepth)) {
      return kInfinity;
    }
    const Vector2d predicted = q.hnormalized();
    const Vector2d residual = view.observation.sqrt_information * (predicted - view.observation.z);
    const double s = residual.squaredNorm();
    cost += kernel.Rho(s);
    if (system != nullptr) {
      Matrix2x3 perspective;
      perspective << 1, 0, -predicted.x(), 0, 1, -predicted.y();
      const Matrix2x3 to_world =
          view.observation.sqrt_information * (perspective / q.z()) * T_WC.rotation.transpose();
      Matrix2x3 jacobian;
      jacobian << to_world * base.rotation.leftCols<2>(), to_world * shift_W;
      const double weight = RobustWeight(kernel.kernel, kernel.scale_sigma, s);
      const Vector3d slope = jacobian.transpose() * residual;
      system->gradient += weight * slope;
      // Newton's curvature of the kernel, along the residual; plain re-weighting converges linearly only.
      system->hessian +=
          weight * jacobian.transpose() * jacobian -
          (weight - RadialCurvature(kernel, s, weight)) / std::max(s, 1e-300) * slope * slope.transpose();
    }
  }
  return cost;
}
}  // namespace

bool SolveLandmark(std::span<const WindowView> views, std::span<const FrameGeometry> geometry,
                   const ObservationKernel& kernel, int max_iterations, Vector3d* landmark,
                   const DepthPrior& prior) {
  LandmarkSystem system;
  double cost = EvaluateLandmark(views, geometry, kernel, *landmark, prior, &system);
  double damping = 0;
  for (int i = 0; i < max_iterations && std::isfinite(cost); ++i) {
    Matrix3d damped = system.hessian;
    damped.diagonal() *= 1 + damping;
    const Vector3d step = -damped.llt().solve(system.gradient);
    const double decrement = -step.dot(system.gradient);
    if (!(decrement > 1e-14 * (1 + cost))) {
      break;
    }
    LandmarkSystem next;
    const Vector3d candidate = *landmark + step;
    const double candidate_cost = EvaluateLandmark(views, geometry, kernel, candidate, prior, &next);
    if (candidate_cost <= cost * (1 + 1e-15)) {
      *landmark = candidate;
      cost = candidate_cost;
      system = next;
      damping = damping < 1e-6 ? 0 : damping * 0.1;
    } else {
      damping = std::max(damping * 100, 1e-4);
      if (damping > 1e8) {
        break;
      }
    }
  }
  return std::isfinite(cost) && landmark->allFinite();
}
double TrackChiSquare(std::span<const WindowView> views, std::span<const FrameGeometry> geometry,
                      const Vector3d& landmark) {
  return EvaluateLandmark(views, geometry, ObservationKernel{}, landmark, {}, nullptr);
}

bool InitializeLandmark(std::span<const WindowView> views, std::span<const FrameGeometry> geometry,
                        double max_relative_deviation, Vector3d* landmark) {
  std::vector<Pose> poses;
  std::vector<Vector2d> z;
  for (const WindowView& view : views) {
    poses.push_back(Geometry(geometry, view).T_WC);
    z.push_back(view.observation.z);
  }
  PoseOnlyDepth depth;
  if (!ComputePoseOnlyDepth(poses, z, 0, DepthViews::kMulti, &depth) || !(std::abs(depth.depth) > 1e-9)) {
    return false;
  }
  *landmark << z.front(), 1.0 / depth.depth;
  const int other_views = static_cast<int>(views.size()) - 1;
  return landmark->allFinite() &&
         DepthIsDetermined(depth, other_views, views.front().observation.deviation(), max_relative_deviation);
}
}  // namespace alidade
