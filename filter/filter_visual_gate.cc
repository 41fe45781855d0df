#include <cmath>

#include "filter/filter_estimator.h"

// Which tracks of a visual update of FilterEstimator pass the gate, and with which weight.

namespace alidade {
namespace {

// The innovation's covariance is that of the state before the update. Where it is large, as after a start,
// tracks that contradict the others pass; at the state that an earlier pass has found they do not fit. That
// state may not be the last one yet, therefore by how much the squared residuals may exceed the gate.
constexpr double kWorstTrackFit = 2;

}  // namespace

void FilterEstimator::MeasureBlocks(const PreparedRows& rows) {
  block_nis_.clear();
  for (const FeatureUpdate::Block& block : update_.blocks()) {
    block_nis_.push_back(state_.covariance().NormalizedInnovationSquared(rows, block.first, block.rows,
                                                                         gate_noise_.variance()));
  }
}

void FilterEstimator::MeasureFit() {
  block_fit_.clear();
  for (size_t i = 0; i < appended_.size(); ++i) {
    const FeatureUpdate::Block& block = update_.blocks()[i];
    block_fit_.push_back(update_.innovation().segment(block.first, block.rows).squaredNorm());
  }
}

bool FilterEstimator::RefuseBlocks(const PreparedRows& rows) {
  MeasureBlocks(rows);
  const auto refuse = [&](bool with_fit) {
    accepted_.assign(appended_.size(), true);
    int refused = 0;
    for (size_t i = 0; i < appended_.size(); ++i) {
      const int dof = update_.blocks()[i].rows;
      accepted_[i] =
          std::isfinite(block_nis_[i]) && gate_.Accepts(block_nis_[i], dof) &&
          (!with_fit || gate_.Accepts(block_fit_[i] / (kWorstTrackFit * gate_noise_.variance()), dof));
      refused += accepted_[i] ? 0 : 1;
    }
    return StateIsSuspect(refused, static_cast<int>(appended_.size()), config_.vision.max_gated_share,
                          kLeastRefusedTracks);
  };
  return (block_fit_.empty() || refuse(true)) && refuse(false);
}

void FilterEstimator::GateBlocks(PreparedRows* rows) {
  bool state_is_suspect = RefuseBlocks(*rows);
  if (state_is_suspect && gate_noise_.lowered()) {
    gate_noise_.Reset();
    state_is_suspect = RefuseBlocks(*rows);
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

}  // namespace alidade
