#include <algorithm>
#include <cmath>

#include "filter/filter_estimator.h"

// Which tracks of a visual update of FilterEstimator pass the gate, and with which weight.

namespace alidade {
namespace {

// Of a misfit, how far its squared residuals exceed the gate: the state is not quite the last one.
constexpr double kMisfit = 2;
// Views of a track that may lose outlying ones while the window's shape is uncertain: tracks of few pass then
// without them even if all are wrong.
constexpr size_t kLeastViewsInDoubt = 12;
// Of the normalised innovation squared of all tracks, in its deviations above its mean: where linearisations
// have not converged and leave more, they have found no window that the tracks agree on.
constexpr double kWorstFit = 4;

}  // namespace

void FilterEstimator::MeasureBlocks(const PreparedRows& rows) {
  block_nis_.clear();
  for (const FeatureUpdate::Block& block : update_.blocks()) {
    block_nis_.push_back(state_.covariance().NormalizedInnovationSquared(rows, block.first, block.rows,
                                                                         gate_noise_.variance()));
  }
}

void FilterEstimator::FindMisfits() {
  const size_t before = misfits_.size();
  for (size_t i = 0; i < appended_.size(); ++i) {
    const FeatureUpdate::Block& block = update_.blocks()[i];
    const double chi_square = update_.innovation().segment(block.first, block.rows).squaredNorm();
    if (!gate_.Accepts(chi_square / (kMisfit * gate_noise_.variance()), block.rows) &&
        !IsMisfit(appended_[i])) {
      misfits_.push_back(appended_[i]);
    }
  }
  if (StateIsSuspect(static_cast<int>(misfits_.size()), static_cast<int>(appended_.size()),
                     config_.vision.max_gated_share, kLeastRefusedTracks)) {
    misfits_.resize(before);
  }
}

bool FilterEstimator::IsMisfit(size_t track) const {
  return std::find(misfits_.begin(), misfits_.end(), track) != misfits_.end();
}

bool FilterEstimator::TracksFit() const {
  const double freedom = statistics_.nis_dof;
  return statistics_.nis < freedom + kWorstFit * std::sqrt(2 * freedom);
}

bool FilterEstimator::RefuseBlocks(const PreparedRows& rows) {
  MeasureBlocks(rows);
  accepted_.assign(appended_.size(), true);
  int refused = 0;
  for (size_t i = 0; i < appended_.size(); ++i) {
    accepted_[i] = std::isfinite(block_nis_[i]) && gate_.Accepts(block_nis_[i], update_.blocks()[i].rows) &&
                   !IsMisfit(appended_[i]);
    refused += accepted_[i] ? 0 : 1;
  }
  return StateIsSuspect(refused, static_cast<int>(appended_.size()), config_.vision.max_gated_share,
                        kLeastRefusedTracks);
}

bool FilterEstimator::MayTakeOutliersOut(const Track& track) const {
  return config_.vision.gate_unit == GateUnit::kObservation && !track.in_state && !track.memory.active &&
         (ShapeIsKnown() || track.views.size() >= kLeastViewsInDoubt);
}

void FilterEstimator::FindOutliers(const PreparedRows& rows) {
  outliers_.clear();
  for (size_t i = 0; i < appended_.size(); ++i) {
    const Track& track = tracks_.tracks()[appended_[i]];
    if (accepted_[i] || IsMisfit(appended_[i]) || !MayTakeOutliersOut(track)) {
      continue;
    }
    const FeatureUpdate::Block& block = update_.blocks()[i];
    Eigen::Ref<Eigen::MatrixXd> maps = update_.NoiseMaps(state_, track, i);
    auto innovation = snooped_.head(block.rows);
    if (state_.covariance().Whiten(rows, block.first, block.rows, gate_noise_.variance(), maps, innovation) &&
        FindOutlyingObservations(gate_, maps, innovation, &outlying_)) {
      for (const int view : outlying_) {
        outliers_.push_back({appended_[i], track.views[static_cast<size_t>(view)].serial});
      }
    }
  }
}

bool FilterEstimator::OutliersMakeACloneSuspect() {
  clone_outliers_.Begin(state_.clones().size());
  for (const size_t index : appended_) {
    const Track& track = tracks_.tracks()[index];
    if (track.in_state || track.memory.active) {
      continue;
    }
    for (const TrackView& view : track.views) {
      clone_outliers_.AddSeen(state_.FindClone(view.serial));
    }
  }
  for (const Outlier& outlier : outliers_) {
    clone_outliers_.AddOutlying(state_.FindClone(outlier.serial));
  }
  return clone_outliers_.AnySuspect(config_.vision.max_gated_share);
}

bool FilterEstimator::TakeOutliersOut(const PreparedRows& rows) {
  FindOutliers(rows);
  if (outliers_.empty() || OutliersMakeACloneSuspect()) {
    return false;
  }
  for (const Outlier& outlier : outliers_) {
    std::vector<TrackView>& views = tracks_.tracks()[outlier.track].views;
    std::erase_if(views, [&](const TrackView& view) { return view.serial == outlier.serial; });
  }
  return true;
}

bool FilterEstimator::TakeOutliersOut(Track* track) {
  if (!MayTakeOutliersOut(*track) || !update_.FindOutliers(state_, *track, &outlying_)) {
    return false;
  }
  for (auto view = outlying_.rbegin(); view != outlying_.rend(); ++view) {
    track->views.erase(track->views.begin() + *view);
  }
  return true;
}

bool FilterEstimator::GateBlocks(PreparedRows* rows) {
  bool state_is_suspect = RefuseBlocks(*rows);
  if (state_is_suspect && gate_noise_.lowered()) {
    gate_noise_.Reset();
    state_is_suspect = RefuseBlocks(*rows);
  }
  if (TakeOutliersOut(*rows)) {
    return false;
  }
  weights_.assign(appended_.size(), 0);
  // Of the last linearisation alone.
  statistics_.features_used = 0;
  statistics_.features_gated = 0;
  statistics_.nis_dof = 0;
  for (size_t i = appended_.size(); i < update_.blocks().size(); ++i) {
    statistics_.nis_dof += update_.blocks()[i].rows;  // rows of no track
  }
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
      weight = std::min(1.0, gate_.Threshold(block.rows) / block_nis_[i]);
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
  return true;
}

}  // namespace alidade
