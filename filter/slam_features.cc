#include "filter/slam_features.h"

#include <algorithm>
#include <cmath>

#include "core/check.h"
#include "filter/landmark_view.h"

namespace alidade {
namespace {

// A landmark that the gate refuses this often in a row is taken for a mismatch.
constexpr int kMaxLandmarkRefusals = 2;

}  // namespace

SlamFeatures::SlamFeatures(const FilterConfig& filter, int max_clones) : filter_(filter) {
  candidates_.resize(static_cast<size_t>(filter.slam_features));
  for (Candidate& candidate : candidates_) {
    candidate.rows.T.resize(3, SquareRootCovariance::kCore + 6 * max_clones);
  }
}

void SlamFeatures::Begin() {
  taken_ = 0;
}

bool SlamFeatures::IsCandidate(const FilterState& state, const Track& track, int serial) const {
  return PlaceIsFree(state) && !track.in_state && !track.memory.active && track.last_serial == serial &&
         track.observations >= filter_.slam_min_track && track.views.size() >= 3;
}

void SlamFeatures::Promote(int serial, TrackStore* tracks, FilterState* state) {
  for (Track& track : tracks->tracks()) {
    if (!PlaceIsFree(*state)) {
      return;
    }
    TrackMemory& memory = track.memory;
    if (!memory.active || memory.carried || track.last_serial != serial ||
        track.observations < filter_.slam_min_track) {
      continue;
    }
    LandmarkRows& rows = promoted_;
    const int anchor = state->landmark_error().anchored() ? memory.anchor : serial;
    rows.landmark = {track.id, anchor, 0, memory.p_W, memory.p_W};
    rows.R_f = memory.landmark_rows;
    rows.t.setZero();
    rows.T.setZero(3, state->covariance().dimension() - state->CoreOffset());
    for (size_t i = 0; i < state->clones().size(); ++i) {
      rows.T.middleCols<6>(state->CloneOffset(i) - state->CoreOffset()) =
          memory.clone_rows.middleCols<6>(6 * state->clones()[i].slot);
    }
    rows.T.rightCols(state->layout().size()) = memory.clone_rows.rightCols(state->layout().size());
    state->AddLandmark(rows);
    memory.active = false;
    track.in_state = true;
  }
}

LandmarkRows* SlamFeatures::TakeRows() {
  CHECK_LT(taken_, candidates_.size());
  return &candidates_[taken_++].rows;
}

void SlamFeatures::ReturnRows() {
  CHECK_GT(taken_, 0u);
  --taken_;
}

void SlamFeatures::AssignBlock(size_t block) {
  CHECK_GT(taken_, 0u);
  candidates_[taken_ - 1].block = block;
}

TrackOutcome SlamFeatures::Append(const FilterState& state, const Track& track, FeatureUpdate* update) {
  const int index = state.FindLandmark(track.id);
  CHECK_GE(index, 0) << "a track without its landmark";
  const Landmark& landmark = state.landmarks()[static_cast<size_t>(index)];
  const Clone& clone = state.clones().back();
  const NormalizedObservation& observation = track.views.back().observation;
  const Eigen::Vector3d& jacobian_p_W = state.JacobianPoint(landmark);
  LandmarkViewRows view;
  if (!LinearizeView(state, clone, observation, landmark.p_W, jacobian_p_W, &view)) {
    return TrackOutcome::kDegenerate;
  }
  const FeatureUpdate::Block block = update->AddBlock(2);
  Eigen::Ref<Eigen::MatrixXd> jacobian = update->jacobian();
  auto rows = jacobian.middleRows<2>(block.first);
  rows.middleCols<6>(state.CloneOffset(state.clones().size() - 1)) = view.clone;
  rows.middleCols(state.CalibrationOffset(), state.layout().size()) = view.calibration;
  rows.middleCols<3>(state.LandmarkOffset(static_cast<size_t>(index))) = view.landmark;
  if (state.landmark_error().anchored()) {
    const auto anchor = static_cast<size_t>(state.FindClone(landmark.anchor_serial));
    rows.middleCols<3>(state.CloneOffset(anchor)) += LandmarkError::OverAnchor(view.landmark, jacobian_p_W);
  }
  update->innovation().segment<2>(block.first) = -view.residual;
  update->TraceNewestObservation(track);
  return TrackOutcome::kReady;
}

void SlamFeatures::Enter(const Eigen::Ref<const Eigen::VectorXd>& correction,
                         const std::vector<double>& block_weights, FilterState* state, TrackStore* tracks) {
  const Eigen::Index old_core = state->CoreOffset();
  const auto moved = correction.tail(correction.size() - old_core);
  for (size_t i = 0; i < taken_; ++i) {
    const double weight = block_weights[candidates_[i].block];
    LandmarkRows& rows = candidates_[i].rows;
    const double scale = std::sqrt(weight);
    if (!(weight > 0) || !(rows.R_f.diagonal().cwiseAbs().minCoeff() > 0)) {
      continue;
    }
    // The state has moved since the rows were linearised.
    rows.t -= rows.T * moved;
    if (state->landmark_error().anchored()) {
      const auto anchor = static_cast<size_t>(state->FindClone(rows.landmark.anchor_serial));
      const int theta = state->CloneOffset(anchor) - state->CoreOffset();
      rows.landmark.p_W = LandmarkError::Turned(moved.segment<3>(theta), rows.landmark.p_W, state->centre());
    }
    rows.R_f *= scale;
    rows.T *= scale;
    rows.t *= scale;
    Track* track = tracks->Find(rows.landmark.id);
    CHECK(track != nullptr);
    state->AddLandmark(rows);
    track->in_state = true;
  }
  taken_ = 0;
}

void SlamFeatures::CountRefusals(bool accepted, const Track& track, FilterState* state) {
  const int index = state->FindLandmark(track.id);
  CHECK_GE(index, 0) << "a track without its landmark";
  int& refusals = state->landmarks()[static_cast<size_t>(index)].refusals;
  refusals = accepted ? 0 : refusals + 1;
}

void SlamFeatures::RemoveEnded(int serial, TrackStore* tracks, FilterState* state) {
  for (size_t i = state->landmarks().size(); i-- > 0;) {
    const Landmark& landmark = state->landmarks()[i];
    Track* track = tracks->Find(landmark.id);
    CHECK(track != nullptr) << "a landmark without its track";
    const bool refused = landmark.refusals >= kMaxLandmarkRefusals;
    if (!refused && track->last_serial == serial) {
      continue;
    }
    track->in_state = false;
    track->observations = 0;
    state->RemoveLandmark(i);
  }
}

}  // namespace alidade
