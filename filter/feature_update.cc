#include "filter/feature_update.h"

#include <cmath>

#include "core/check.h"

namespace alidade {

using Eigen::Index;

FeatureUpdate::FeatureUpdate(const FilterConfig& filter, const VisionConfig& vision, int max_clones)
    : filter_(filter), vision_(vision) {
  const auto views = static_cast<size_t>(max_clones);
  poses_.reserve(views);
  points_.reserve(views);
  observations_.reserve(views);
  offsets_.reserve(views);
  chains_.reserve(views);
  track_jacobian_.resize(2 * max_clones, 6 * max_clones);
  Reserve(512);
}

void FeatureUpdate::Begin(const FilterState& state) {
  rows_ = 0;
  dimension_ = state.covariance().dimension();
  blocks_.clear();
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
  points_.clear();
  observations_.clear();
  offsets_.clear();
  chains_.clear();
  const bool inflate_base = filter_.base_reuse == BaseReuse::kInflate && track.base_rounds > 0;
  for (const TrackView& view : track.views) {
    const int index = state.FindClone(view.serial);
    CHECK_GE(index, 0) << "a track refers to a clone that left the window";
    const Clone& clone = state.clones()[static_cast<size_t>(index)];
    poses_.push_back(clone.T_WC);
    points_.push_back(view.observation.z);
    observations_.push_back(view.observation);
    if (inflate_base && observations_.size() == 1) {
      observations_.back().sqrt_information /= filter_.base_inflation;
    }
    offsets_.push_back(state.CloneOffset(static_cast<size_t>(index)));
    chains_.push_back(&clone.camera_from_error);
  }
  return poses_.size() >= 2;
}

TrackOutcome FeatureUpdate::Triangulate(Eigen::Vector3d* p_W) const {
  PoseOnlyDepth depth;
  const DepthViews views =
      filter_.landmark == FilterLandmark::kPoseOnlyTwo ? DepthViews::kTwo : DepthViews::kMulti;
  if (!ComputePoseOnlyDepth(poses_, points_, 0, views, &depth)) {
    return TrackOutcome::kWaiting;
  }
  const int other_views = views == DepthViews::kTwo ? 1 : static_cast<int>(poses_.size()) - 1;
  if (!DepthIsDetermined(depth, other_views, observations_.back().deviation(),
                         vision_.max_relative_depth_deviation)) {
    return TrackOutcome::kWaiting;
  }
  if (depth.depth < vision_.min_depth_m || depth.depth > vision_.max_depth_m) {
    return TrackOutcome::kDegenerate;
  }
  *p_W = depth.p_W;
  if (filter_.landmark == FilterLandmark::kMsckf &&
      !RefineLandmark(poses_, observations_, 0, filter_.refine_iterations, p_W)) {
    return TrackOutcome::kDegenerate;
  }
  return TrackOutcome::kReady;
}

TrackOutcome FeatureUpdate::Append(const FilterState& state, const Track& track) {
  if (!GatherViews(state, track)) {
    return TrackOutcome::kWaiting;
  }
  Eigen::Vector3d p_W;
  const TrackOutcome outcome = Triangulate(&p_W);
  if (outcome != TrackOutcome::kReady) {
    return outcome;
  }
  if (!LinearizeTrack(poses_, observations_, p_W, &linearization_)) {
    return TrackOutcome::kDegenerate;
  }
  const Index views = static_cast<Index>(poses_.size());
  // Tracing eliminates the landmark from the identity too: what is left maps the observations' noise.
  const Index columns = (tracing_ ? 8 : 6) * views;
  if (track_jacobian_.cols() < columns) {
    track_jacobian_.resize(track_jacobian_.rows(), 8 * track_jacobian_.rows() / 2);
  }
  auto dense = track_jacobian_.topLeftCorner(2 * views, columns);
  dense.setZero();
  dense.rightCols(columns - 6 * views).setIdentity();
  for (Index k = 0; k < views; ++k) {
    dense.block<2, 6>(2 * k, 6 * k).noalias() =
        linearization_.pose_jacobians.middleRows<2>(2 * k) * *chains_[static_cast<size_t>(k)];
  }
  EliminateLandmark(linearization_.point_jacobian, dense, linearization_.residual);
  const Index kept = 2 * views - 3;
  Reserve(static_cast<int>(kept));
  jacobian_.block(rows_, 0, kept, dimension_).setZero();
  for (Index k = 0; k < views; ++k) {
    jacobian_.block(rows_, offsets_[static_cast<size_t>(k)], kept, 6) = dense.block(3, 6 * k, kept, 6);
  }
  innovation_.segment(rows_, kept) = -linearization_.residual.tail(kept);
  blocks_.push_back({rows_, static_cast<int>(kept)});
  rows_ += static_cast<int>(kept);
  if (tracing_) {
    Trace(track, dense.bottomRightCorner(kept, 2 * views));
  }
  return TrackOutcome::kReady;
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

}  // namespace alidade
