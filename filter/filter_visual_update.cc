#include <cmath>

#include "filter/filter_estimator.h"
#include "filter/window_shape.h"

// The visual update of FilterEstimator: which rows, where they are linearised, and what becomes of their
// tracks.

namespace alidade {
namespace {

// A remembered track that is refused more often in a row is taken for another point.
constexpr int kMaxRefusals = 1;
// Square of what may be neglected in the linearisation of an update, in standard deviations of one row, once
// the window's shape is known and before. What is neglected has the same sign in every update, that of a
// larger scale. While the scale is uncertain, a repeated update takes noise for it.
constexpr double kNegligible = 1e-3;
constexpr double kNegligibleUncertain = 0.1;
// Least share of the due tracks that update together while the window's shape is uncertain.
constexpr double kMostTracks = 0.7;
// Largest deformation of the window between two linearisations. Gauss-Newton steps that are longer jump
// between shapes, and end where the scale has vanished.
constexpr double kLongestStep = 0.3;
// Square of the step, in deviations of what the update leaves, that ends the linearisations of an update with
// all tracks. Along a scale that they hardly see the cost is flat far beyond its deviation.
constexpr double kLastStep = 0.1;

}  // namespace

void FilterEstimator::AppendTrack(size_t index, int leaving_serial) {
  Track& track = tracks_.tracks()[index];
  TrackOutcome outcome = TrackOutcome::kWaiting;
  if (track.in_state) {
    if (track.last_serial != serial_) {
      return;
    }
    outcome = slam_.Append(state_, track, &update_);
  } else if (due_ == DueTracks::kUsual && slam_.IsCandidate(state_, track, serial_)) {
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
      if (TakeOutliersOut(&track)) {
        AppendTrack(index, leaving_serial);
      } else {
        degenerate_.push_back(index);
      }
      break;
  }
}

int FilterEstimator::AppendDueTracks(int leaving_serial) {
  const std::vector<Track>& tracks = tracks_.tracks();
  slam_.Begin();
  update_.Begin(state_);
  appended_.clear();
  degenerate_.clear();
  statistics_.features_waiting = 0;
  for (size_t i = 0; i < tracks.size(); ++i) {
    if (!tracks[i].in_state) {
      AppendTrack(i, leaving_serial);
    }
  }
  const int landmark_rows = update_.rows();
  for (size_t i = 0; i < tracks.size(); ++i) {
    if (tracks[i].in_state) {
      AppendTrack(i, leaving_serial);
    }
  }
  if (due_ == DueTracks::kAll) {
    AppendScaleVolume();
  }
  return landmark_rows;
}

int FilterEstimator::ChooseAndAppendTracks(int leaving_serial) {
  due_ = DueTracks::kUsual;
  const double limit = config_.filter.max_direction_deviation;
  if (!(limit > 0)) {
    return AppendDueTracks(leaving_serial);
  }
  if (baseline_.across > limit) {
    due_ = DueTracks::kAll;
    const int landmark_rows = AppendDueTracks(leaving_serial);
    const double ready = static_cast<double>(appended_.size());
    if (ready >= kMostTracks * (ready + statistics_.features_waiting)) {
      return landmark_rows;
    }
    due_ = DueTracks::kLeaving;
  } else if (baseline_.along > limit) {
    due_ = DueTracks::kLeaving;
  }
  return AppendDueTracks(leaving_serial);
}

void FilterEstimator::CorrectByTracks(Eigen::Ref<Eigen::VectorXd> errors) {
  Correct();
  if (carry_scale_) {
    scale_direction_.Carry(&state_, errors);
  }
}

bool FilterEstimator::MoveByTracks(Eigen::Ref<Eigen::VectorXd> corrected) {
  SquareRootCovariance& covariance = state_.covariance();
  const double explained = covariance.Solution(Correction());
  Correction() -= corrected;
  const double deformation = RelativeDeformation(state_, Correction());
  const double negligible = ShapeIsKnown() ? kNegligible : kNegligibleUncertain;
  auto whitened = whitened_.head(covariance.dimension());
  if (!(deformation * deformation * explained > negligible) ||
      (due_ == DueTracks::kAll && covariance.SquaredStep(whitened) < kLastStep)) {
    return false;
  }
  const double share = deformation > kLongestStep ? kLongestStep / deformation : 1;
  Correction() *= share;
  whitened += share * (covariance.WhitenedSolution() - whitened);
  corrected += Correction();
  moved_.head(corrected.size()) += Correction();
  CorrectByTracks(corrected);
  ++statistics_.iterations;
  return true;
}

bool FilterEstimator::FactorDueTracks(int landmark_rows, int leaving_serial,
                                      const Eigen::Ref<const Eigen::VectorXd>& corrected) {
  if (!corrected.isZero(0)) {
    // The prior is about the prediction, the rows about the state.
    update_.innovation().noalias() += update_.jacobian() * corrected;
  }
  if (observer_ != nullptr) {
    observed_ = {update_.jacobian(), update_.innovation(), update_.traces(), RowSource::kVision};
  }
  PreparedRows rows = update_.Prepare(landmark_rows, &state_.covariance());
  if (!GateBlocks(&rows)) {
    const int landmark_rows_left = AppendDueTracks(leaving_serial);
    return appended_.empty() || FactorDueTracks(landmark_rows_left, leaving_serial, corrected);
  }
  return state_.covariance().Factor(rows, &statistics_.nis);
}

void FilterEstimator::GiveUp(Eigen::Ref<Eigen::VectorXd> corrected) {
  statistics_.features_waiting += static_cast<int>(appended_.size());
  statistics_.features_used = 0;
  statistics_.features_gated = 0;
  statistics_.nis = 0;
  statistics_.nis_dof = 0;
  appended_.clear();
  Correction() = -moved_.head(corrected.size());
  CorrectByTracks(corrected);
}

void FilterEstimator::CommitDueTracks(const Eigen::Ref<const Eigen::VectorXd>& corrected) {
  if (observer_ != nullptr) {
    observer_->OnUpdate(state_, observed_);
  }
  state_.covariance().Commit(Correction());
  Correction() -= corrected;
  updated_serial_ = serial_;
  carry_scale_ = ScaleIsUncertain() && scale_direction_.Take(state_, updated_serial_);
}

bool FilterEstimator::CorrectWithDueTracks(int leaving_serial) {
  auto corrected = corrected_.head(state_.covariance().dimension());
  corrected.setZero();
  moved_.head(corrected.size()).setZero();
  whitened_.head(corrected.size()).setZero();
  misfits_.clear();
  state_.strain().Mark();
  carry_scale_ = ScaleIsUncertain() && scale_direction_.Take(state_, updated_serial_);
  bool settled = false;
  for (int pass = 1;; ++pass) {
    const int landmark_rows =
        pass == 1 ? ChooseAndAppendTracks(leaving_serial) : AppendDueTracks(leaving_serial);
    if (settled) {
      FindMisfits();
    }
    if (!appended_.empty() && !FactorDueTracks(landmark_rows, leaving_serial, corrected)) {
      return false;
    }
    if (appended_.empty()) {
      if (pass > 1) {
        GiveUp(corrected);
      }
      return true;
    }
    const bool last = pass == config_.filter.update_iterations;
    if (last && pass > 1 && due_ == DueTracks::kAll && !TracksFit()) {
      degenerate_.clear();  // seen from where the cameras are not
      GiveUp(corrected);
      return true;
    }
    const bool moved = !last && MoveByTracks(corrected);
    if (!moved && (last || settled || pass == 1)) {
      break;
    }
    settled = !moved;  // then one more pass, without the tracks that do not fit here
    if (carry_scale_ && state_.strain().ExceedsNoise()) {
      // The direction carried is no longer one along which the IMU's prior knows the scale.
      scale_direction_.TakeBack(&state_);
      corrected = moved_.head(corrected.size());
      carry_scale_ = false;
    }
  }
  CommitDueTracks(corrected);
  return true;
}

bool FilterEstimator::UpdateWithDueTracks(int leaving_serial) {
  std::vector<Track>& tracks = tracks_.tracks();
  state_.covariance().AllowSingle(SingleSuffices());
  const bool corrected = CorrectWithDueTracks(leaving_serial);
  state_.covariance().AllowSingle(false);
  if (!corrected) {
    return false;
  }
  statistics_.features_degenerate += static_cast<int>(degenerate_.size());
  for (const size_t index : degenerate_) {
    RetireViews(&tracks[index], false);
    tracks[index].memory.active = false;
  }
  if (appended_.empty()) {
    return true;
  }
  for (size_t block = 0; block < appended_.size(); ++block) {
    Track& track = tracks[appended_[block]];
    gate_noise_.AddTrack(block_nis_[block], update_.blocks()[block].rows);
    if (accepted_[block]) {
      pixel_noise_.AddTrack(gate_noise_.variance() * block_nis_[block], update_.blocks()[block].rows);
      update_.Remember(state_, block, weights_[block], block_nis_[block], &track);
    } else if (track.memory.active && ++track.memory.refusals > kMaxRefusals) {
      track.memory.active = false;
    }
  }
  const auto correction = Correction();  // of the dimension before landmarks enter
  state_.strain().MarkNewest();
  CorrectByTracks(corrected_.head(0));
  slam_.Enter(correction, weights_, &state_, &tracks_);
  CorrectScale();
  for (size_t block = 0; block < appended_.size(); ++block) {
    RetireViews(&tracks[appended_[block]], accepted_[block]);
  }
  return true;
}

TrackOutcome FilterEstimator::AppendViews(const Track& track, int leaving_serial) {
  if (track.memory.active) {
    return update_.AppendRemembered(state_, track);
  }
  // A memory needs a good depth to start from; the last chance to use the views does not.
  const bool last_chance = track.last_serial != serial_ || track.views.front().serial == leaving_serial;
  const bool to_remember = config_.filter.track_memory != TrackMemoryPolicy::kNone && !last_chance;
  if (due_ == DueTracks::kAll) {
    return update_.Append(state_, track, config_.filter.max_direction_deviation);
  }
  return to_remember ? update_.AppendToRemember(state_, track) : update_.Append(state_, track);
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
