#include "smoother/tracks/track_system.h"

#include <Eigen/Cholesky>
#include <cmath>

#include "core/predicted_observation.h"
#include "core/reprojection.h"

namespace alidade {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kMaxInverseDepth = 1e4;  // [1/m]; where a landmark ran into its camera no row can be trusted

/// The depth prior on rho, the inverse depth in the base view.
void AddDepthPrior(const DepthPrior& prior, const FrameGeometry& base, const BearingPlane& base_plane,
                   const Vector3d& landmark, const CalibrationLayout& layout, TrackWorkspace* workspace) {
  const double rho = landmark.z();
  const Eigen::Matrix<double, 1, 6> camera = InverseDepthRow(base, landmark, base_plane);
  const Eigen::Matrix<double, 1, 6> pose = prior.sqrt_information * camera * base.camera_from_body;
  const double residual = prior.sqrt_information * (rho - prior.mean);
  workspace->prior_residual = residual;
  workspace->prior_calibration.noalias() = prior.sqrt_information * camera * CalibrationChain(layout, base);
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
  FrameGeometry base_row;
  FrameGeometry view_row;
  const FrameGeometry& base = AtRow(geometry, views.front(), &base_row);
  workspace->rows.resize(views.size());
  workspace->coupling.resize(views.size());
  workspace->eliminated.poses.resize(views.size());
  workspace->landmark_hessian.setZero();
  workspace->landmark_gradient.setZero();
  workspace->robust_cost = 0;
  workspace->chi2 = 0;
  for (size_t k = 0; k < views.size(); ++k) {
    ViewRows& rows = workspace->rows[k];
    if (!LinearizeView(base, AtRow(geometry, views[k], &view_row), views[k].observation, kernel, landmark,
                       &rows, views.front().observation.plane)) {
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

/// Cholesky factor of diag(scale) H diag(scale), H the Hessian of a landmark. The unit of the inverse depth
/// is arbitrary: H is scaled to a unit diagonal before its pivots are tested.
struct LandmarkFactor {
  explicit LandmarkFactor(const Matrix3d& hessian)
      : scale(hessian.diagonal().cwiseSqrt().cwiseInverse()),
        factor(scale.asDiagonal() * hessian * scale.asDiagonal()) {}

  [[nodiscard]] bool ok() const { return scale.allFinite() && factor.info() == Eigen::Success; }

  Vector3d scale;
  Eigen::LLT<Matrix3d> factor;
};

/// The calibration's part of AddTrack, once the poses' is done.
void AddCalibration(std::span<const WindowView> views, std::span<const FrameGeometry> geometry,
                    const DepthPrior& prior, TrackWorkspace* workspace, PoseSystem* system) {
  const WindowCalibration& calibration = *system->calibration;
  const Eigen::Index size = calibration.size();
  const Eigen::Index first = system->columns.Calibration().first;
  EliminatedLandmark& eliminated = workspace->eliminated;
  eliminated.calibration.resize(size, 3);
  if (size == 0) {
    return;
  }
  CalibrationRowPair rows(2, size);
  EliminatedLandmark::Calibration coupling = EliminatedLandmark::Calibration::Zero(size, 3);
  CalibrationInformation own = CalibrationInformation::Zero(size, size);
  auto gradient = system->gradient.segment(first, size);
  FrameGeometry view_row;
  for (size_t k = 0; k < views.size(); ++k) {
    const ViewRows& view = workspace->rows[k];
    const FrameGeometry& frame = AtRow(geometry, views[k], &view_row);
    CalibrationRows(calibration.layout, calibration.mean.camera, frame.R_WB,
                    {&frame.camera_from_time, &frame.camera_from_line_delay}, view.camera,
                    Predicted(views[k].observation, view.residual), rows);
    const CalibrationColumnPair weighted = view.weight * rows.transpose();
    coupling.noalias() += weighted * view.landmark;
    own.noalias() += weighted.lazyProduct(rows);
    gradient.noalias() += weighted * view.residual;
    system->hessian.block(first, workspace->first[k], size, kPoseColumns).noalias() += weighted * view.pose;
  }
  if (prior.sqrt_information > 0) {
    const Eigen::RowVectorXd& row = workspace->prior_calibration;
    coupling.col(2) += row.transpose() * prior.sqrt_information;
    own.noalias() += row.transpose().lazyProduct(row);
    gradient += row.transpose() * workspace->prior_residual;
    system->hessian.block(first, workspace->first[0], size, kPoseColumns).noalias() +=
        row.transpose() * workspace->prior_pose;
  }
  eliminated.calibration = coupling * eliminated.root;
  const EliminatedLandmark::Calibration& reduced = eliminated.calibration;
  own.noalias() -= reduced.lazyProduct(reduced.transpose());
  system->hessian.block(first, first, size, size) += own;
  gradient.noalias() -= reduced * eliminated.gradient;
  for (size_t k = 0; k < views.size(); ++k) {
    system->hessian.block(first, workspace->first[k], size, kPoseColumns).noalias() -=
        reduced * eliminated.poses[k].transpose();
  }
}

}  // namespace

/// d rho = drho - rho dz_b, z_b the depth along the plane's normal of (x, y, 1) in the base view.
Eigen::Matrix<double, 1, 6> InverseDepthRow(const FrameGeometry& base, const Vector3d& landmark,
                                            const BearingPlane& base_plane) {
  const double rho = landmark.z();
  const Vector3d normal = base_plane.axes().col(2);
  Eigen::Matrix<double, 1, 6> camera;
  camera << -rho * normal.transpose() * Skew(base_plane.Direction(landmark.head<2>())),
      rho * rho * (base.Linearized().rotation * normal).transpose();
  return camera;
}

bool LinearizeView(const FrameGeometry& base, const FrameGeometry& frame,
                   const NormalizedObservation& observation, const ObservationKernel& kernel,
                   const Vector3d& landmark, ViewRows* rows, const BearingPlane& base_plane) {
  const Eigen::Matrix2d& whitening = observation.sqrt_information;
  Vector2d predicted;
  PointRows<2> projection;
  AnchoredPointInCamera seen(base.T_WC, frame.T_WC, landmark, base_plane);
  if (!ProjectToPlane(observation.plane, seen.q, kMinScaledDepth, &predicted, &projection)) {
    return false;
  }
  rows->residual = whitening * (predicted - observation.z);
  if (base.T_WC_first || frame.T_WC_first) {
    seen = AnchoredPointInCamera(base.Linearized(), frame.Linearized(), landmark, base_plane);
    if (!ProjectToPlane(observation.plane, seen.q, kMinScaledDepth, &predicted, &projection)) {
      return false;
    }
  }
  const PointRows<2> over_q = whitening * projection;
  seen.Chain(over_q, nullptr, &rows->camera, &rows->landmark);
  rows->pose.noalias() = rows->camera * frame.camera_from_body;
  rows->squared_norm = rows->residual.squaredNorm();
  rows->weight = kernel.Weight(rows->squared_norm);
  return true;
}

PoseSystem::PoseSystem(int frames, const WindowCalibration* of_camera) : calibration(of_camera) {
  for (int i = 0; i < frames; ++i) {
    columns.AddPose(i);
  }
  columns.AddCalibration(calibration->size());
  hessian = Eigen::MatrixXd::Zero(columns.size(), columns.size());
  gradient = Eigen::VectorXd::Zero(columns.size());
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
    FrameGeometry row;
    AddDepthPrior(prior, AtRow(geometry, views.front(), &row), views.front().observation.plane, landmark,
                  system->calibration->layout, workspace);
  }
  const LandmarkFactor own(workspace->landmark_hessian);
  if (!own.ok() || !(own.factor.matrixLLT().diagonal().minCoeff() > 1e-7)) {
    return false;
  }
  EliminatedLandmark& eliminated = workspace->eliminated;
  eliminated.gradient = own.factor.matrixL().solve(own.scale.asDiagonal() * workspace->landmark_gradient);
  const Matrix3d scaled = own.scale.asDiagonal();
  eliminated.root = own.factor.matrixL().solve(scaled).transpose();
  workspace->first.resize(views.size());
  for (size_t k = 0; k < views.size(); ++k) {
    workspace->first[k] = system->columns.Frame(views[k].frame->index).first;
  }
  const Eigen::Index base_row = workspace->first.front();
  system->hessian.block<6, 6>(base_row, base_row) += workspace->prior_hessian;
  system->gradient.segment<6>(base_row) += workspace->prior_gradient;
  for (size_t k = 0; k < views.size(); ++k) {
    const Eigen::Index row = workspace->first[k];
    const ViewRows& rows = workspace->rows[k];
    eliminated.poses[k].noalias() = workspace->coupling[k] * eliminated.root;
    system->hessian.block<6, 6>(row, row).noalias() += rows.weight * rows.pose.transpose() * rows.pose;
    system->gradient.segment<6>(row).noalias() += rows.weight * rows.pose.transpose() * rows.residual;
    system->gradient.segment<6>(row).noalias() -= eliminated.poses[k] * eliminated.gradient;
    for (size_t l = 0; l <= k; ++l) {
      system->hessian.block<6, 6>(row, workspace->first[l]).noalias() -=
          eliminated.poses[k] * eliminated.poses[l].transpose();
    }
  }
  AddCalibration(views, geometry, prior, workspace, system);
  system->robust_cost += workspace->robust_cost;
  system->chi2 += workspace->chi2;
  system->dof += 2 * static_cast<int>(views.size()) - 3;
  ++system->tracks;
  return true;
}

std::optional<double> InverseDepthDeviation(std::span<const WindowView> views,
                                            std::span<const FrameGeometry> geometry,
                                            const ObservationKernel& kernel, const Vector3d& landmark) {
  TrackWorkspace workspace;
  if (!LinearizeViews(views, geometry, kernel, landmark, &workspace)) {
    return std::nullopt;
  }
  const LandmarkFactor own(workspace.landmark_hessian);
  if (!own.ok()) {
    return std::nullopt;
  }
  return own.scale.z() * std::sqrt(own.factor.solve(Vector3d::UnitZ()).z());
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
