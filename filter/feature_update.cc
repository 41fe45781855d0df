#include "filter/feature_update.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/check.h"
#include "core/landmark_reduction.h"
#include "core/robust.h"
#include "filter/landmark_view.h"

namespace alidade {

using Eigen::Index;

namespace {

constexpr double kLeniency = 1.5;  // the two measures of the depth's deviation differ by less

/// A memory is tested at every view. With the gate's error shared by the views of a window, a point that
/// stands still is refused in a window with that probability at most.
double DriftLimit(double gate_probability, int window) {
  return ChiSquareQuantile(2, 1 - (1 - gate_probability) / window);
}

}  // namespace

FeatureUpdate::FeatureUpdate(const FilterConfig& filter, const VisionConfig& vision, int max_clones,
                             int calibration_size)
    : filter_(filter),
      vision_(vision),
      drift_limit_(DriftLimit(vision.gate_probability, filter.window)),
      calibration_(calibration_size),
      keeper_(filter, max_clones, calibration_size) {
  const auto views = static_cast<size_t>(max_clones);
  poses_.reserve(views);
  observations_.reserve(views);
  offsets_.reserve(views);
  clones_.reserve(views);
  residual_.resize(2 * max_clones);
  point_jacobian_.resize(2 * max_clones, 3);
  track_jacobian_.resize(2 * max_clones, 6 * max_clones + calibration_);
  Reserve(1024);  // untouched rows take no memory
  successors_.resize(kUsualTracks);
  for (TrackMemory& successor : successors_) {
    successor.clone_rows.resize(
        3, filter.track_memory != TrackMemoryPolicy::kNone ? 6 * max_clones + calibration_ : 0);
  }
  blocks_.reserve(kUsualTracks);
  points_.reserve(kUsualTracks);
}

void FeatureUpdate::Begin(const FilterState& state) {
  rows_ = 0;
  prepared_ = false;
  dimension_ = state.covariance().dimension();
  blocks_.clear();
  points_.clear();
  traces_.clear();
  if (jacobian_.cols() < state.covariance().capacity()) {
    jacobian_.resize(jacobian_.rows(), state.covariance().capacity());
  }
}

void FeatureUpdate::Reserve(int additional_rows) {
  const Index needed = rows_ + additional_rows;
  if (needed > innovation_.size()) {
    const Index grown = std::max<Index>(needed, 2 * innovation_.size());
    jacobian_.conservativeResize(grown, jacobian_.cols());
    innovation_.conservativeResize(grown);
  }
}

bool FeatureUpdate::GatherViews(const FilterState& state, const Track& track) {
  poses_.clear();
  observations_.clear();
  offsets_.clear();
  clones_.clear();
  const bool inflate_base = filter_.base_reuse == BaseReuse::kInflate && track.base_rounds > 0;
  for (const TrackView& view : track.views) {
    const int index = state.FindClone(view.serial);
    CHECK_GE(index, 0) << "a track refers to a clone that left the window";
    const Clone& clone = state.clones()[static_cast<size_t>(index)];
    poses_.push_back(state.CameraPoseAt(clone, view.observation));
    observations_.push_back(view.observation);
    if (inflate_base && observations_.size() == 1) {
      observations_.back().sqrt_information /= filter_.base_inflation;
    }
    offsets_.push_back(state.CloneOffset(static_cast<size_t>(index)));
    clones_.push_back(index);
  }
  return poses_.size() >= 2;
}

TrackOutcome FeatureUpdate::Triangulate(double max_relative_deviation, bool refine,
                                        Eigen::Vector3d* p_W) const {
  PoseOnlyDepth depth;
  const DepthViews views =
      filter_.landmark == FilterLandmark::kPoseOnlyTwo ? DepthViews::kTwo : DepthViews::kMulti;
  if (!TriangulateLandmark(poses_, observations_, views, max_relative_deviation, &depth)) {
    return TrackOutcome::kWaiting;
  }
  if (depth.depth < vision_.min_depth_m || depth.depth > vision_.max_depth_m) {
    return TrackOutcome::kDegenerate;
  }
  *p_W = depth.p_W;
  if (refine && !RefineLandmark(poses_, observations_, filter_.refine_iterations, p_W)) {
    return TrackOutcome::kDegenerate;
  }
  return TrackOutcome::kReady;
}

bool FeatureUpdate::Linearize(const FilterState& state, const Eigen::Vector3d& p_W) {
  const Index views = static_cast<Index>(clones_.size());
  // Tracing eliminates the landmark from the identity too: what is left maps the observations' noise.
  const Index columns = StateColumns() + (tracing_ ? 2 * views : 0);
  if (track_jacobian_.cols() < columns) {
    track_jacobian_.resize(track_jacobian_.rows(), 8 * track_jacobian_.rows() / 2 + calibration_);
  }
  auto dense = track_jacobian_.topLeftCorner(2 * views, columns);
  dense.setZero();
  dense.rightCols(columns - StateColumns()).setIdentity();
  LandmarkViewRows rows;
  for (Index k = 0; k < views; ++k) {
    const auto view = static_cast<size_t>(k);
    const Clone& clone = state.clones()[static_cast<size_t>(clones_[view])];
    if (!LinearizeView(state, clone, observations_[view], p_W, p_W, &rows)) {
      return false;
    }
    residual_.segment<2>(2 * k) = rows.residual;
    point_jacobian_.middleRows<2>(2 * k) = rows.landmark;
    dense.block<2, 6>(2 * k, 6 * k) = rows.clone;
    dense.block(2 * k, 6 * views, 2, calibration_) = rows.calibration;
  }
  return true;
}

void FeatureUpdate::RetainRows(const FilterState& state, const Track& track, const Eigen::Vector3d& p_W,
                               LandmarkRows* rows) const {
  const int core = state.CoreOffset();
  rows->landmark = {track.id, track.views.back().serial, 0, p_W, p_W};
  rows->R_f = point_jacobian_.topRows<3>().triangularView<Eigen::Upper>();
  rows->T.setZero(3, dimension_ - core);
  for (size_t k = 0; k < offsets_.size(); ++k) {
    rows->T.middleCols<6>(offsets_[k] - core) = track_jacobian_.block<3, 6>(0, 6 * static_cast<Index>(k));
  }
  rows->T.rightCols(calibration_) =
      track_jacobian_.block(0, 6 * static_cast<Index>(offsets_.size()), 3, calibration_);
  if (state.landmark_error().anchored()) {
    rows->T.middleCols<3>(offsets_.back() - core) += LandmarkError::OverAnchor(rows->R_f, p_W);
  }
  rows->t = -residual_.head<3>();
}

TrackOutcome FeatureUpdate::AppendToRemember(const FilterState& state, const Track& track) {
  // Cheaper than the exact test of a memory, which follows.
  const double lenient = kLeniency * filter_.memory_depth_deviation;
  return AppendViews(
      state, track,
      {.max_depth_deviation = std::min(vision_.max_relative_depth_deviation, lenient), .to_remember = true});
}

TrackOutcome FeatureUpdate::AppendViews(const FilterState& state, const Track& track,
                                        const Purpose& purpose) {
  if (!GatherViews(state, track)) {
    return TrackOutcome::kWaiting;
  }
  Eigen::Vector3d p_W;
  const bool refine = purpose.landmark_rows != nullptr || filter_.landmark == FilterLandmark::kMsckf ||
                      filter_.track_memory != TrackMemoryPolicy::kNone;
  const TrackOutcome outcome = Triangulate(purpose.max_depth_deviation, refine, &p_W);
  if (outcome != TrackOutcome::kReady) {
    return outcome;
  }
  if (!Linearize(state, p_W)) {
    return TrackOutcome::kDegenerate;
  }
  const Index views = static_cast<Index>(clones_.size());
  auto point_jacobian = point_jacobian_.topRows(2 * views);
  if (purpose.to_remember && !keeper_.MayStart(point_jacobian, p_W, poses_.back().translation)) {
    return TrackOutcome::kWaiting;
  }
  auto dense = track_jacobian_.topLeftCorner(2 * views, StateColumns() + (tracing_ ? 2 * views : 0));
  EliminateLandmark(point_jacobian, dense, residual_.head(2 * views));
  if (purpose.landmark_rows != nullptr && purpose.to_remember &&
      !keeper_.StateAllows(state, p_W, point_jacobian_.topRows<3>(), dense.topRows(3), clones_)) {
    return TrackOutcome::kWaiting;
  }
  if (learn_scene_depth_) {
    scene_depth_.Add((p_W - poses_.back().translation).norm());
  }
  const Block block = AddBlock(static_cast<int>(2 * views - 3));
  points_.back() = p_W;
  for (Index k = 0; k < views; ++k) {
    jacobian_.block(block.first, offsets_[static_cast<size_t>(k)], block.rows, 6) =
        dense.block(3, 6 * k, block.rows, 6);
  }
  jacobian_.block(block.first, state.CalibrationOffset(), block.rows, calibration_) =
      dense.block(3, 6 * views, block.rows, calibration_);
  innovation_.segment(block.first, block.rows) = -residual_.segment(3, block.rows);
  if (purpose.landmark_rows != nullptr) {
    RetainRows(state, track, p_W, purpose.landmark_rows);
  } else {
    StartMemory(state, dense.topRows(3), p_W);
  }
  if (tracing_) {
    Trace(track, dense.bottomRightCorner(block.rows, 2 * views));
  }
  return TrackOutcome::kReady;
}

void FeatureUpdate::StartMemory(const FilterState& state, const Eigen::Ref<const Eigen::MatrixXd>& clone_rows,
                                const Eigen::Vector3d& p_W) {
  if (filter_.track_memory == TrackMemoryPolicy::kNone) {
    return;
  }
  const Eigen::Matrix3d landmark_rows = point_jacobian_.topRows<3>().triangularView<Eigen::Upper>();
  const Eigen::Vector3d move = landmark_rows.triangularView<Eigen::Upper>().solve(-residual_.head<3>());
  keeper_.Start(state, p_W + move, landmark_rows, clone_rows, clones_, &successors_[blocks_.size() - 1]);
}

void FeatureUpdate::Trace(const Track& track, const Eigen::Ref<const Eigen::MatrixXd>& noise) {
  TracedBlock trace{blocks_.back().first, blocks_.back().rows, track.id, {}, noise};
  for (size_t k = 0; k < track.views.size(); ++k) {
    trace.serials.push_back(track.views[k].serial);
    // Rows are whitened by what the update assumes, which for a re-used base may be more than its noise.
    trace.noise.middleCols<2>(2 * static_cast<Index>(k)) *=
        observations_[k].sqrt_information * track.views[k].observation.sqrt_information.inverse();
  }
  traces_.push_back(std::move(trace));
}

TrackOutcome FeatureUpdate::AppendRemembered(const FilterState& state, const Track& track) {
  const TrackView& view = track.views.back();
  const int clone = state.FindClone(view.serial);
  CHECK_GE(clone, 0) << "a track refers to a clone that left the window";
  if (successors_.size() <= blocks_.size()) {
    successors_.emplace_back();
  }
  if (!keeper_.Extend(state, track.memory, static_cast<size_t>(clone), view.observation, 1.0,
                      &successors_[blocks_.size()])) {
    return TrackOutcome::kDegenerate;
  }
  const Block block = AddBlock(2);
  successors_[blocks_.size() - 1].active = true;
  for (size_t i = 0; i < state.clones().size(); ++i) {
    jacobian_.block<2, 6>(block.first, state.CloneOffset(i)) =
        keeper_.jacobian().middleCols<6>(6 * state.clones()[i].slot);
  }
  jacobian_.block(block.first, state.CalibrationOffset(), 2, calibration_) =
      keeper_.jacobian().rightCols(calibration_);
  innovation_.segment<2>(block.first) = keeper_.innovation();
  if (tracing_) {
    // The noise of the views behind a memory is not followed.
    traces_.push_back({block.first, 2, track.id, {}, Eigen::MatrixXd(2, 0)});
  }
  return TrackOutcome::kReady;
}

FeatureUpdate::Block FeatureUpdate::AddBlock(int rows) {
  Reserve(rows);
  const Block block{rows_, rows};
  jacobian_.block(rows_, 0, rows, dimension_).setZero();
  blocks_.push_back(block);
  points_.emplace_back(Eigen::Vector3d::Zero());
  rows_ += rows;
  if (successors_.size() < blocks_.size()) {
    successors_.emplace_back();
  }
  successors_[blocks_.size() - 1].active = false;
  return block;
}

void FeatureUpdate::Remember(const FilterState& state, size_t block, double weight, double nis,
                             Track* track) {
  if (filter_.track_memory == TrackMemoryPolicy::kNone) {
    return;
  }
  TrackMemory& successor = successors_[block];
  const bool further_view = track->memory.active;
  if (weight < 1 && track->memory.active) {
    const TrackView& view = track->views.back();
    successor.active = keeper_.Extend(state, track->memory, static_cast<size_t>(state.FindClone(view.serial)),
                                      view.observation, std::sqrt(weight), &successor);
  } else if (weight < 1) {
    successor.landmark_rows *= std::sqrt(weight);
    successor.clone_rows *= std::sqrt(weight);
  }
  successor.active = successor.active && keeper_.MayStay(successor, state.clones().back().T_WC.translation);
  if (further_view) {
    successor.AddInnovation(nis);
    successor.active = successor.active && !successor.Drifts(drift_limit_);
  }
  std::swap(track->memory, successor);
}

}  // namespace alidade
