#include "smoother/track_system.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>

#include "core/pose_only.h"
#include "core/predicted_observation.h"
#include "core/robust.h"

namespace alidade {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Matrix2x3 = Eigen::Matrix<double, 2, 3>;

constexpr double kMaxInverseDepth = 1e4;  // [1/m]; where a landmark ran into its camera no row can be trusted
constexpr double kMinViewDepth = 1e-6;    // of the scaled point (x, y, 1) + rho t
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

/// Row of the depth prior on rho, the inverse depth in the base view: d rho = drho - rho dz_b, z_b the depth
/// of (x, y, 1) there.
void AddDepthPrior(const DepthPrior& prior, const FrameGeometry& base, const Vector3d& landmark,
                   const CalibrationLayout* layout, TrackWorkspace* workspace) {
  const double rho = landmark.z();
  const Vector3d ray = landmark.head<2>().homogeneous();
  Eigen::Matrix<double, 1, 6> camera;
  camera << -rho * Skew(ray).row(2), rho * rho * base.T_WC.rotation.col(2).transpose();
  const Eigen::Matrix<double, 1, 6> pose = prior.sqrt_information * camera * base.camera_from_body;
  const double residual = prior.sqrt_information * (rho - prior.mean);
  workspace->prior_residual = residual;
  if (layout != nullptr) {
    workspace->prior_calibration.noalias() =
        prior.sqrt_information * camera * CalibrationChain(*layout, base);
  }
  workspace->prior_pose = pose;
  workspace->prior_hessian.noalias() = pose.transpose() * pose;
  workspace->prior_gradient.noalias() = pose.transpose() * residual;
  workspace->coupling[0].col(2).noalias() += pose.transpose() * prior.sqrt_information;
  workspace->landmark_hessian(2, 2) += prior.sqrt_information * prior.sqrt_information;
  workspace->landmark_gradient.z() += prior.sqrt_information * residual;
  workspace->robust_cost += residual * residual;
}

/// Weighted rows of every view over its own pose and the landmark. False behind a view.
bool LinearizeViews(std::span<const WindowView> views, std::span<const FrameGeometry> geometry,
                    const ObservationKernel& kernel, const Vector3d& landmark, TrackWorkspace* workspace) {
  const Pose& base = Geometry(geometry, views.front()).T_WC;
  workspace->rows.resize(views.size());
  workspace->coupling.resize(views.size());
  workspace->reduced.resize(views.size());
  workspace->landmark_hessian.setZero();
  workspace->landmark_gradient.setZero();
  workspace->robust_cost = 0;
  workspace->chi2 = 0;
  for (size_t k = 0; k < views.size(); ++k) {
    ViewRows& rows = workspace->rows[k];
    if (!LinearizeView(base, Geometry(geometry, views[k]), views[k].observation, kernel, landmark, &rows)) {
      return false;
    }
    workspace->robust_cost += kernel.Rho(rows.squared_norm);
    workspace->chi2 += rows.squared_norm;
    workspace->coupling[k].noalias() = rows.weight * rows.pose.transpose() * rows.landmark;
    workspace->landmark_hessian.noalias() += rows.weight * rows.landmark.transpose() * rows.landmark;
    workspace->landmark_gradient.noalias() += rows.weight * rows.landmark.transpose() * rows.residual;
  }
  return true;
}

/// The calibration's part of AddTrack, once the poses' is done: `landmark_root` is L^-T of the scaled
/// landmark Hessian.
void AddCalibration(std::span<const WindowView> views, std::span<const FrameGeometry> geometry,
                    const Matrix3d& landmark_root, const Vector3d& reduced_gradient, bool has_prior,
                    const DepthPrior& prior, const TrackWorkspace& workspace, PoseSystem* system) {
  const WindowCalibration& calibration = *system->calibration;
  const Eigen::Index size = calibration.size();
  const Eigen::Index first = system->hessian.rows() - size;
  Eigen::MatrixXd rows(2, size);
  Eigen::MatrixXd coupling = Eigen::MatrixXd::Zero(size, 3);
  auto own = system->hessian.bottomRightCorner(size, size);
  auto gradient = system->gradient.tail(size);
  for (size_t k = 0; k < views.size(); ++k) {
    const ViewRows& view = workspace.rows[k];
    const FrameGeometry& frame = Geometry(geometry, views[k]);
    CalibrationRows(calibration.layout, calibration.mean.camera, frame.R_WB, &frame.camera_from_time,
                    view.camera, Predicted(views[k].observation, view.residual), rows);
    coupling.noalias() += view.weight * rows.transpose() * view.landmark;
    own.noalias() += view.weight * rows.transpose() * rows;
    gradient.noalias() += view.weight * rows.transpose() * view.residual;
    system->hessian.block(first, 6 * views[k].frame->index, size, 6).noalias() +=
        view.weight * rows.transpose() * view.pose;
  }
  if (has_prior) {
    const Eigen::RowVectorXd& row = workspace.prior_calibration;
    coupling.col(2) += row.transpose() * prior.sqrt_information;
    own.noalias() += row.transpose() * row;
    gradient += row.transpose() * workspace.prior_residual;
    system->hessian.block(first, 6 * views.front().frame->index, size, 6).noalias() +=
        row.transpose() * workspace.prior_pose;
  }
  const Eigen::MatrixXd reduced = coupling * landmark_root;
  own.noalias() -= reduced * reduced.transpose();
  gradient.noalias() -= reduced * reduced_gradient;
  for (size_t k = 0; k < views.size(); ++k) {
    system->hessian.block(first, 6 * views[k].frame->index, size, 6).noalias() -=
        reduced * workspace.reduced[k].transpose();
  }
}

}  // namespace

double ObservationKernel::Rho(double s) const {
  const double k2 = scale_sigma * scale_sigma;
  switch (kernel) {
    case RobustKernel::kHuber:
      return s <= k2 ? s : 2 * scale_sigma * std::sqrt(s) - k2;
    case RobustKernel::kCauchy:
      return k2 * std::log1p(s / k2);
    case RobustKernel::kNone:
      break;
  }
  return s;
}

FrameGeometry MakeGeometry(const NavState& state, const Pose& T_BC) {
  return {state.T_WB() * T_BC, BodyToCameraJacobian(state.R_WB, T_BC)};
}

std::vector<FrameGeometry> MakeGeometry(const Window& window, const Pose& T_BC) {
  std::vector<FrameGeometry> geometry;
  geometry.reserve(static_cast<size_t>(window.size()));
  for (const std::unique_ptr<WindowFrame>& frame : window.frames()) {
    geometry.push_back(MakeGeometry(frame->nav_state(), T_BC));
  }
  return geometry;
}

FrameGeometry MakeGeometry(const WindowFrame& frame, const NavState& state, const CameraCalibration& camera) {
  const double later_s = camera.time_offset_s - frame.time_offset_s;
  const Matrix3d turn = so3::Exp(Vector3d(frame.rates.head<3>() * later_s));
  FrameGeometry geometry;
  geometry.R_WB = state.R_WB * turn;
  const Vector3d p_WB = state.p_WB + frame.rates.tail<3>() * later_s;
  geometry.T_WC = Pose{geometry.R_WB, p_WB} * camera.T_BC;
  const Matrix6d camera_from_moved = BodyToCameraJacobian(geometry.R_WB, camera.T_BC);
  geometry.camera_from_body = camera_from_moved;
  geometry.camera_from_body.leftCols<3>() = camera_from_moved.leftCols<3>() * turn.transpose();
  geometry.camera_from_time = camera_from_moved * frame.rates;
  return geometry;
}

std::vector<FrameGeometry> MakeGeometry(const Window& window, const CameraCalibration& camera) {
  std::vector<FrameGeometry> geometry;
  geometry.reserve(static_cast<size_t>(window.size()));
  for (const std::unique_ptr<WindowFrame>& frame : window.frames()) {
    geometry.push_back(MakeGeometry(*frame, frame->nav_state(), camera));
  }
  return geometry;
}

CameraFromCalibration CalibrationChain(const CalibrationLayout& layout, const FrameGeometry& frame) {
  CameraFromCalibration chain = CameraFromCalibration::Zero(6, layout.size());
  if (layout.extrinsics() >= 0) {
    chain.middleCols<6>(layout.extrinsics()) = ExtrinsicsToCameraJacobian(frame.R_WB);
  }
  if (layout.time_offset() >= 0) {
    chain.col(layout.time_offset()) = frame.camera_from_time;
  }
  return chain;
}

bool LinearizeView(const Pose& base, const FrameGeometry& frame, const NormalizedObservation& observation,
                   const ObservationKernel& kernel, const Vector3d& landmark, ViewRows* rows) {
  const Vector3d shift_W = base.translation - frame.T_WC.translation;
  const Vector3d ray_W = base.rotation * landmark.head<2>().homogeneous();
  const double rho = landmark.z();
  const Vector3d q = frame.T_WC.rotation.transpose() * (ray_W + rho * shift_W);
  if (!(q.z() > kMinViewDepth)) {
    return false;
  }
  const Vector2d predicted = q.hnormalized();
  Matrix2x3 perspective;
  perspective << 1, 0, -predicted.x(), 0, 1, -predicted.y();
  const Matrix2x3 weighted = observation.sqrt_information * (perspective / q.z());
  const Matrix2x3 to_world = weighted * frame.T_WC.rotation.transpose();
  rows->landmark << to_world * base.rotation.leftCols<2>(), to_world * shift_W;
  rows->camera << weighted * Skew(q), -rho * to_world;
  rows->pose.noalias() = rows->camera * frame.camera_from_body;
  rows->residual = observation.sqrt_information * (predicted - observation.z);
  rows->squared_norm = rows->residual.squaredNorm();
  rows->weight = RobustWeight(kernel.kernel, kernel.scale_sigma, rows->squared_norm);
  return true;
}

PoseSystem::PoseSystem(int frames, const WindowCalibration* of_camera) : calibration(of_camera) {
  const Eigen::Index size = 6 * frames + calibration_size();
  hessian = Eigen::MatrixXd::Zero(size, size);
  gradient = Eigen::VectorXd::Zero(size);
}

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

bool AddTrack(std::span<const WindowView> views, std::span<const FrameGeometry> geometry,
              const ObservationKernel& kernel, const Vector3d& landmark, TrackWorkspace* workspace,
              PoseSystem* system, const DepthPrior& prior) {
  if (!(std::abs(landmark.z()) < kMaxInverseDepth) ||
      !LinearizeViews(views, geometry, kernel, landmark, workspace)) {
    return false;
  }
  workspace->prior_hessian.setZero();
  workspace->prior_gradient.setZero();
  if (prior.sqrt_information > 0) {
    AddDepthPrior(prior, Geometry(geometry, views.front()), landmark,
                  system->calibration == nullptr ? nullptr : &system->calibration->layout, workspace);
  }
  // The inverse depth's unit is arbitrary: scaled to a unit diagonal before its pivots are judged.
  const Vector3d scale = workspace->landmark_hessian.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::LLT<Matrix3d> factor(scale.asDiagonal() * workspace->landmark_hessian * scale.asDiagonal());
  if (!scale.allFinite() || factor.info() != Eigen::Success ||
      !(factor.matrixLLT().diagonal().minCoeff() > 1e-7)) {
    return false;
  }
  const Vector3d reduced_gradient = factor.matrixL().solve(scale.asDiagonal() * workspace->landmark_gradient);
  const Matrix3d scaled = scale.asDiagonal();
  const Matrix3d inverse_transposed = factor.matrixL().solve(scaled).transpose();
  const int base_row = 6 * views.front().frame->index;
  system->hessian.block<6, 6>(base_row, base_row) += workspace->prior_hessian;
  system->gradient.segment<6>(base_row) += workspace->prior_gradient;
  for (size_t k = 0; k < views.size(); ++k) {
    const int row = 6 * views[k].frame->index;
    const ViewRows& rows = workspace->rows[k];
    workspace->reduced[k].noalias() = workspace->coupling[k] * inverse_transposed;
    system->hessian.block<6, 6>(row, row).noalias() += rows.weight * rows.pose.transpose() * rows.pose;
    system->gradient.segment<6>(row).noalias() += rows.weight * rows.pose.transpose() * rows.residual;
    system->gradient.segment<6>(row).noalias() -= workspace->reduced[k] * reduced_gradient;
    for (size_t l = 0; l <= k; ++l) {
      system->hessian.block<6, 6>(row, 6 * views[l].frame->index).noalias() -=
          workspace->reduced[k] * workspace->reduced[l].transpose();
    }
  }
  if (system->calibration_size() > 0) {
    AddCalibration(views, geometry, inverse_transposed, reduced_gradient, prior.sqrt_information > 0, prior,
                   *workspace, system);
  }
  system->robust_cost += workspace->robust_cost;
  system->chi2 += workspace->chi2;
  system->dof += 2 * static_cast<int>(views.size()) - 3;
  ++system->tracks;
  return true;
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

void SquareRootRows(const Eigen::MatrixXd& hessian, const Eigen::VectorXd& gradient,
                    Eigen::MatrixXd* jacobian, Eigen::VectorXd* residual) {
  const Eigen::Index size = hessian.rows();
  Eigen::MatrixXd lower = hessian;  // left-looking Cholesky on the lower triangle
  *residual = gradient;
  for (Eigen::Index j = 0; j < size; ++j) {
    const double pivot = lower(j, j) - lower.row(j).head(j).squaredNorm();
    const Eigen::Index below = size - j - 1;
    if (!(pivot > 1e-13 * hessian(j, j)) || !(hessian(j, j) > 0)) {
      lower.col(j).tail(below + 1).setZero();
      (*residual)[j] = 0;
      continue;
    }
    const double root = std::sqrt(pivot);
    lower.col(j).tail(below).noalias() -= lower.bottomLeftCorner(below, j) * lower.row(j).head(j).transpose();
    lower.col(j).tail(below) /= root;
    lower(j, j) = root;
    (*residual)[j] /= root;
    residual->tail(below).noalias() -= (*residual)[j] * lower.col(j).tail(below);
  }
  *jacobian = lower.triangularView<Eigen::Lower>().transpose();
}

}  // namespace alidade
