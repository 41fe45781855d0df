#include "smoother/factors/slam_prior.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "smoother/manifold/dense_blas.h"

namespace alidade {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kMaxPriorIterations = 15;
constexpr double kDecrementTolerance = 1e-9;  // of the cost
constexpr double kMaxDamping = 1e8;
// A landmark with rows of the prior alone may have no depth there: its block is made regular.
constexpr double kRegularization = 1e-10;

}  // namespace

std::vector<const WindowTrack*> PriorTracks(const LinearPrior& prior, const Window& window) {
  std::vector<const WindowTrack*> tracks;
  for (const LinearPrior::Landmark& landmark : prior.landmarks) {
    const auto found = window.tracks().find(landmark.track_id);
    const bool known = found != window.tracks().end() && found->second.anchor != nullptr;
    tracks.push_back(known ? &found->second : nullptr);
  }
  return tracks;
}

/// Normal equations of the views over landmarks and, when asked for, frames.
struct SlamPrior::Views {
  std::vector<Eigen::Matrix3d> landmark_hessian;
  VectorXd landmark_gradient;
  double robust_cost = 0;
  MatrixXd coupling;       ///< 3L x columns
  MatrixXd frame_hessian;  ///< full
  VectorXd frame_gradient;

  /// A view's part over the calibration, whose columns begin at `at`, and over its landmark.
  void AddCalibration(const AnchoredRows& rows, Index landmark, Index at) {
    const Index size = rows.calibration.cols();
    if (size == 0) {
      return;
    }
    const CalibrationColumnPair weighted = rows.weight * rows.calibration.transpose();
    coupling.block(landmark, at, 3, size).noalias() += (weighted * rows.landmark).transpose();
    frame_hessian.block(at, at, size, size).noalias() += weighted.lazyProduct(rows.calibration);
    frame_gradient.segment(at, size).noalias() += weighted * rows.residual;
  }
  /// And between the calibration and a pose.
  void Couple(const AnchoredRows& rows, const Eigen::Matrix<double, 2, 6>& pose, Index pose_at, Index at) {
    const Index size = rows.calibration.cols();
    if (size == 0) {
      return;
    }
    const CameraFromCalibration both = rows.weight * pose.transpose() * rows.calibration;
    frame_hessian.block(pose_at, at, 6, size) += both;
    frame_hessian.block(at, pose_at, size, 6) += both.transpose();
  }
};

SlamPrior::SlamPrior(const LinearPrior* prior, std::vector<const WindowTrack*> tracks, const Window& window,
                     const WindowCalibration& calibration, const ObservationKernel& kernel)
    : prior_(prior),
      tracks_(std::move(tracks)),
      kernel_(kernel),
      window_(&window),
      calibration_(&calibration),
      prior_columns_(prior->columns()),
      columns_(PriorColumns(window.size(), prior->clock_origin.has_value(), calibration.size())) {
  MatrixXd rows(prior->jacobian.rows(), prior->jacobian.cols() + 1);
  rows << prior->jacobian, prior->residual;
  FormGram(rows, &gram_);
  gram_.triangularView<Eigen::StrictlyUpper>() = gram_.transpose();
  origins_.resize(3 * static_cast<Index>(prior->landmarks.size()));
  for (size_t i = 0; i < prior->landmarks.size(); ++i) {
    origins_.segment<3>(3 * static_cast<Index>(i)) = prior->landmarks[i].origin;
  }
}

SlamPrior::Scene SlamPrior::MakeScene(const WindowPoint& point) const {
  Scene scene;
  scene.calibration = WindowCalibration{calibration_->layout, point.camera};
  for (size_t i = 0; i < point.states.size(); ++i) {
    const WindowFrame& frame = window_->frame(static_cast<int>(i));
    scene.geometry.push_back(MakeGeometry(frame, point.states[i], point.camera));
  }
  scene.spread = prior_->SpreadAt(point.states);
  scene.frames = prior_->ErrorsAt(point.states, scene.spread, LinearPrior::Derivative::kHere);
  scene.units.setOnes(origins_.size());
  for (Index i = 2; i < origins_.size(); i += 3) {
    scene.units[i] = scene.spread.ratio;
  }
  scene.renormalized.resize(tracks_.size());
  for (size_t i = 0; i < tracks_.size(); ++i) {
    scene.views.push_back(tracks_[i] == nullptr ? nullptr
                                                : &Renormalized(scene.calibration, calibration_->mean,
                                                                tracks_[i]->views, &scene.renormalized[i]));
  }
  return scene;
}

VectorXd SlamPrior::StartingLandmarks() const {
  VectorXd landmarks = origins_;
  for (size_t i = 0; i < tracks_.size(); ++i) {
    if (tracks_[i] != nullptr) {
      landmarks.segment<3>(3 * static_cast<Index>(i)) = tracks_[i]->landmark;
    }
  }
  return landmarks;
}

bool SlamPrior::See(const Scene& scene, const VectorXd& landmarks, bool with_frames, Views* views) const {
  const ColumnMap::Range camera = columns_.Calibration();
  views->landmark_hessian.assign(tracks_.size(), Eigen::Matrix3d::Zero());
  views->landmark_gradient.setZero(landmarks.size());
  views->robust_cost = 0;
  if (with_frames) {
    views->coupling.setZero(landmarks.size(), columns_.size());
    views->frame_hessian.setZero(columns_.size(), columns_.size());
    views->frame_gradient.setZero(columns_.size());
  }
  for (size_t i = 0; i < tracks_.size(); ++i) {
    if (tracks_[i] == nullptr) {
      continue;
    }
    const Index row = 3 * static_cast<Index>(i);
    const int anchor = tracks_[i]->anchor->index;
    for (const WindowView& view : *scene.views[i]) {
      AnchoredRows rows;
      if (!LinearizeAnchoredView(*tracks_[i], view, scene.geometry, kernel_, landmarks.segment<3>(row), &rows,
                                 with_frames, scene.calibration)) {
        return false;
      }
      views->robust_cost += kernel_.Rho(rows.squared_norm);
      const Eigen::Matrix<double, 3, 2> weighted = rows.weight * rows.landmark.transpose();
      views->landmark_hessian[i].noalias() += weighted * rows.landmark;
      views->landmark_gradient.segment<3>(row).noalias() += weighted * rows.residual;
      if (with_frames) {
        views->AddCalibration(rows, row, camera.first);
      }
      if (!with_frames || view.frame->index == anchor) {
        continue;  // seen from its own anchor a landmark concerns no pose
      }
      Eigen::Matrix<double, 2, 12> both;
      both << rows.anchor, rows.view;
      const Eigen::Matrix<double, 12, 12> hessian = rows.weight * both.transpose() * both;
      const Eigen::Matrix<double, 12, 1> gradient = rows.weight * both.transpose() * rows.residual;
      const std::array<Index, 2> at = {columns_.Frame(anchor).first, columns_.Frame(view.frame->index).first};
      for (int k = 0; k < 2; ++k) {
        views->coupling.block<3, 6>(row, at[k]).noalias() += weighted * both.middleCols<6>(6 * k);
        views->frame_gradient.segment<6>(at[k]) += gradient.segment<6>(6 * k);
        for (int l = 0; l < 2; ++l) {
          views->frame_hessian.block<6, 6>(at[k], at[l]) += hessian.block<6, 6>(6 * k, 6 * l);
        }
        views->Couple(rows, both.middleCols<6>(6 * k), at[k], camera.first);
      }
    }
  }
  return true;
}

MatrixXd SlamPrior::LandmarkHessian(const Views& views, const Scene& scene, double damping) const {
  const Index frames = gram_.cols() - 1 - origins_.size();
  MatrixXd hessian = scene.units.asDiagonal() *
                     gram_.block(frames, frames, origins_.size(), origins_.size()) * scene.units.asDiagonal();
  for (size_t i = 0; i < tracks_.size(); ++i) {
    const Index row = 3 * static_cast<Index>(i);
    hessian.block<3, 3>(row, row) += views.landmark_hessian[i];
  }
  hessian.diagonal() *= 1 + kRegularization + damping;
  return hessian;
}

double SlamPrior::CostAtOrigins(const VectorXd& xi) const {
  const Index frames = xi.size();
  const Index last = gram_.cols() - 1;
  return gram_(last, last) +
         xi.dot(2 * gram_.block(0, last, frames, 1).col(0) + gram_.topLeftCorner(frames, frames) * xi);
}

bool SlamPrior::Minimize(const VectorXd& xi, const Scene& scene, VectorXd* landmarks, double* cost) const {
  const Index frames = xi.size();
  const Index size = landmarks->size();
  const auto landmark_gram = gram_.block(frames, frames, size, size);
  const VectorXd slope =
      gram_.block(frames, frames + size, size, 1) + gram_.block(frames, 0, size, frames) * xi;
  const double offset = CostAtOrigins(xi);
  const auto shift = [&](const VectorXd& at) -> VectorXd { return scene.units.cwiseProduct(at) - origins_; };
  const auto total = [&](const VectorXd& at, const VectorXd& pull, const Views& views) {
    return offset + shift(at).dot(slope + pull) + views.robust_cost;
  };
  Views views;
  if (!See(scene, *landmarks, false, &views)) {
    return false;
  }
  VectorXd pull = slope + landmark_gram * shift(*landmarks);
  *cost = total(*landmarks, pull, views);
  double damping = 0;
  for (int k = 0; k < kMaxPriorIterations; ++k) {
    const VectorXd gradient = scene.units.cwiseProduct(pull) + views.landmark_gradient;
    VectorXd step = -gradient;
    MatrixXd hessian = LandmarkHessian(views, scene, damping);
    if (!FactorLower(&hessian)) {
      return false;
    }
    SolveCholesky(hessian, &step);
    if (!(-step.dot(gradient) > kDecrementTolerance * (1 + *cost))) {
      break;
    }
    const VectorXd candidate = *landmarks + step;
    Views next;
    const bool in_front = See(scene, candidate, false, &next);
    const VectorXd next_pull = slope + landmark_gram * shift(candidate);
    const double next_cost = in_front ? total(candidate, next_pull, next) : *cost;
    if (in_front && next_cost <= *cost) {
      *landmarks = candidate;
      *cost = next_cost;
      views = std::move(next);
      pull = next_pull;
      damping = damping < 1e-6 ? 0 : damping * 0.1;
    } else {
      damping = std::max(damping * 100, 1e-4);
      if (damping > kMaxDamping) {
        break;
      }
    }
  }
  return std::isfinite(*cost) && landmarks->allFinite();
}

bool SlamPrior::SolveLandmarks(const WindowPoint& point, VectorXd* landmarks, double* cost) const {
  const Scene scene = MakeScene(point);
  const VectorXd xi = Displacement(point, scene);
  if (landmarks->size() == 0) {
    *cost = CostAtOrigins(xi);
    return std::isfinite(*cost);
  }
  return Minimize(xi, scene, landmarks, cost);
}

bool SlamPrior::Linearize(const WindowPoint& point, const VectorXd& landmarks,
                          NormalEquations* equations) const {
  const Scene scene = MakeScene(point);
  const VectorXd xi = Displacement(point, scene);
  Views views;
  if (!See(scene, landmarks, true, &views)) {
    return false;
  }
  const Index frames = xi.size();
  const Index size = landmarks.size();
  const VectorXd scaled = scene.units.cwiseProduct(landmarks);
  const VectorXd pull = gram_.col(frames + size) + gram_.leftCols(frames) * xi +
                        gram_.middleCols(frames, size) * (scaled - origins_);
  VectorXd along_scale = VectorXd::Zero(size);
  for (Index i = 2; i < size; i += 3) {
    along_scale[i] = scaled[i];
  }
  const Eigen::RowVectorXd spread = SpreadRow(scene.spread);
  MatrixXd chained = ChainFrames(point, scene, gram_.leftCols(frames));
  chained.noalias() += (gram_.middleCols(frames, size) * along_scale) * spread;
  equations->hessian = ChainFrames(point, scene, chained.topRows(frames).transpose()) + views.frame_hessian;
  equations->hessian.noalias() += (chained.middleRows(frames, size).transpose() * along_scale) * spread;
  equations->gradient =
      ChainFrames(point, scene, pull.head(frames).transpose()).transpose() + views.frame_gradient;
  equations->gradient.noalias() += along_scale.dot(pull.segment(frames, size)) * spread.transpose();

  if (size == 0) {
    return equations->hessian.allFinite();
  }
  MatrixXd hessian = LandmarkHessian(views, scene, 0);
  if (!FactorLower(&hessian)) {
    return false;
  }
  MatrixXd coupling = scene.units.asDiagonal() * chained.middleRows(frames, size) + views.coupling;
  VectorXd gradient = scene.units.cwiseProduct(pull.segment(frames, size)) + views.landmark_gradient;
  SolveLower(hessian, coupling);
  SolveLower(hessian, gradient);
  SubtractGram(coupling, &equations->hessian);
  equations->gradient.noalias() -= coupling.transpose() * gradient;
  return equations->hessian.allFinite();
}

}  // namespace alidade
