#include <cmath>

#include "filter/filter_estimator.h"

// The visual update of FilterEstimator: which rows, which of them pass the gate, and what becomes of their
// tracks.

namespace alidade {
namespace {

// A remembered track that is refused more often in a row is taken for another point.
constexpr int kMaxRefusals = 1;

}  // namespace

void FilterEstimator::AppendTrack(size_t index, int leaving_serial) {
  Track& track = tracks_.tracks()[index];
  TrackOutcome outcome = TrackOutcome::kWaiting;
  if (track.in_state) {
    if (track.last_serial != serial_) {
      return;
    }
    outcome = slam_.Append(state_, track, &update_);
  } else if (slam_.IsCandidate(state_, track, serial_)) {
    outcome = update_.AppendLandmark(state_, track, slam_.TakeRows());
    if (outcome == TrackOutcome::kReady) {
      slam_.AssignBlock(update_.blocks().size() - 1);
    } else {
      slam_.ReturnRows();
    }
  }
  if (outcome != TrackOutcome::kReady && !track.in_state) {
    if (!IsDue(track, leaving_serial)) {
      return;
    }
    outcome = AppendViews(track, leaving_serial);
  }
  switch (outcome) {
    case TrackOutcome::kReady:
      appended_.push_back(index);
      break;
    case TrackOutcome::kWaiting:
      ++statistics_.features_waiting;
      break;
    case TrackOutcome::kDegenerate:
      ++statistics_.features_degenerate;
      RetireViews(&track, false);
      track.memory.active = false;
      break;
  }
}

bool FilterEstimator::UpdateWithDueTracks(int leaving_serial) {
  std::vector<Track>& tracks = tracks_.tracks();
  slam_.Begin();
  slam_.Promote(serial_, &tracks_, &state_);
  update_.Begin(state_);
  appended_.clear();
  for (size_t i = 0; i < tracks.size(); ++i) {
    if (!tracks[i].in_state) {
      AppendTrack(i, leaving_serial);
    }
  }
  const int landmark_rows = update_.rows();  // where they begin
  for (size_t i = 0; i < tracks.size(); ++i) {
    if (tracks[i].in_state) {
      AppendTrack(i, leaving_serial);
    }
  }
  if (appended_.empty()) {
    return true;
  }
  if (observer_ != nullptr) {
    observed_ = {update_.jacobian(), update_.innovation(), update_.traces(), RowSource::kVision};
  }
  PreparedRows rows = update_.Prepare(landmark_rows, &state_.covariance());
  GateBlocks(&rows);
  if (observer_ != nullptr) {
    observer_->OnUpdate(state_, observed_);
  }
  if (!state_.covariance().Apply(rows, Correction(), &statistics_.nis)) {
    return false;
  }
  for (size_t block = 0; block < appended_.size(); ++block) {
    Track& track = tracks[appended_[block]];
    if (accepted_[block]) {
      update_.Remember(state_, block, weights_[block], &track);
    } else if (track.memory.active && ++track.memory.refusals > kMaxRefusals) {
      track.memory.active = false;
    }
  }
  const auto correction = Correction();  // of the dimension before landmarks enter
  Correct();
  slam_.Enter(correction, weights_, &state_, &tracks_);
  for (size_t block = 0; block < appended_.size(); ++block) {
    RetireViews(&tracks[appended_[block]], accepted_[block]);
  }
  return true;
}

TrackOutcome FilterEstimator::AppendViews(const Track& track, int leaving_serial) {
  if (track.memory.active) {
    return update_.AppendRemembered(state_, track);
  }
  // A memory wants a good depth to start from; the last chance to use the views does not.
  const bool last_chance = track.last_serial != serial_ || track.views.front().serial == leaving_serial;
  const bool to_remember = config_.filter.track_memory != TrackMemoryPolicy::kNone && !last_chance;
  return update_.Append(state_, track, to_remember);
}

void FilterEstimator::MeasureBlocks(const PreparedRows& rows) {
  block_nis_.clear();
  for (const FeatureUpdate::Block& block : update_.blocks()) {
    block_nis_.push_back(state_.covariance().NormalizedInnovationSquared(rows, block.first, block.rows));
  }
}

void FilterEstimator::GateBlocks(PreparedRows* rows) {
  MeasureBlocks(*rows);
  accepted_.assign(appended_.size(), true);
  weights_.assign(appended_.size(), 0);
  int refused = 0;
  for (size_t i = 0; i < appended_.size(); ++i) {
    accepted_[i] = std::isfinite(block_nis_[i]) && gate_.Accepts(block_nis_[i], update_.blocks()[i].rows);
    refused += accepted_[i] ? 0 : 1;
  }
  const bool state_is_suspect = StateIsSuspect(refused, static_cast<int>(appended_.size()),
                                               config_.vision.max_gated_share, kLeastRefusedTracks);
  statistics_.suspect = state_is_suspect;
  for (size_t i = 0; i < appended_.size(); ++i) {
    const FeatureUpdate::Block& block = update_.blocks()[i];
    double weight = 0;
    if (accepted_[i]) {
      // The kernel acts on an observation's two rows; a track's rows share one weight of the same mean
      // square.
      weight = RobustWeight(config_.vision.robust_kernel, config_.vision.robust_scale_sigma,
                            2 * block_nis_[i] / block.rows);
    } else if (state_is_suspect && std::isfinite(block_nis_[i])) {
      accepted_[i] = true;
      weight = gate_.Threshold(block.rows) / block_nis_[i];
    }
    weights_[i] = weight;
    ++(accepted_[i] ? statistics_.features_used : statistics_.features_gated);
    statistics_.nis_dof += accepted_[i] ? block.rows : 0;
    if (weight < 1) {
      rows->Scale(block.first, block.rows, std::sqrt(weight));
      if (observer_ != nullptr) {
        observed_.jacobian.middleRows(block.first, block.rows) *= std::sqrt(weight);
        observed_.innovation.segment(block.first, block.rows) *= std::sqrt(weight);
        for (TracedBlock& trace : observed_.blocks) {
          // A block that a memory made has no trace.
          trace.noise *= trace.first == block.first ? std::sqrt(weight) : 1.0;
        }
      }
    }
  }
}

void FilterEstimator::RetireViews(Track* track, bool used) {
  const FilterConfig& filter = config_.filter;
  if (track->in_state) {
    track->views.clear();
    SlamFeatures::CountRefusals(used, *track, &state_);
    return;
  }
  if (!used || filter.update != UpdateTiming::kImmediate || filter.track_memory != TrackMemoryPolicy::kNone) {
    track->views.clear();
    track->base_rounds = 0;
    return;
  }
  ++track->base_rounds;
  const bool base_exhausted =
      filter.base_reuse == BaseReuse::kDisjoint ||
      (filter.base_reuse == BaseReuse::kLimit && track->base_rounds >= filter.max_base_rounds);
  if (base_exhausted) {
    track->views.clear();
    track->base_rounds = 0;
    return;
  }
  track->views.resize(1);
}

}  // namespace alidade
