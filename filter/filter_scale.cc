#include <cmath>

#include "filter/filter_estimator.h"

// What FilterEstimator does about the scale of its window while that is uncertain (docs/track_memory.md,
// "Starts and large corrections").

namespace alidade {
namespace {

// Largest relative deviation of a window of known shape, and of a scale that is corrected.
constexpr double kKnownShape = 0.1;
// Relative deviation of the scale above which its direction is carried.
constexpr double kKnownScale = 0.02;
// Largest step that corrects the scale, in deviations of the scale. The gradient is of second order in the
// corrections: a larger one is of their neglected terms.
constexpr double kLongestScaleStep = 0.2;
// Largest deviation of a position error in single precision, which then holds it to 1e-5 m.
constexpr double kMostUncertainPosition_m = 100;
// Degrees of freedom of the direction of a motion.
constexpr double kDirectionFreedom = 2;

}  // namespace

bool FilterEstimator::ShapeIsKnown() const {
  return baseline_.along < kKnownShape && baseline_.across < kKnownShape;
}

bool FilterEstimator::SingleSuffices() const {
  // While the window's shape is uncertain, the update has weak directions, which a single rounds away. Far
  // from the origin the attitude's deviation is in the position's error.
  const int core = state_.CoreOffset();
  return ShapeIsKnown() && state_.covariance().PoseBlock(core, core).diagonal().tail<3>().maxCoeff() <
                               kMostUncertainPosition_m * kMostUncertainPosition_m;
}

void FilterEstimator::AppendScaleVolume() {
  if (!scale_direction_.Take(state_, serial_)) {
    return;
  }
  const FeatureUpdate::Block block = update_.AddBlock(1);
  update_.jacobian().row(block.first) = std::sqrt(kDirectionFreedom) * scale_direction_.row().transpose();
  update_.innovation()(block.first) = std::sqrt(kDirectionFreedom);
}

bool FilterEstimator::ScaleIsUncertain() const {
  // While the direction of the motion is not known either, the covariance holds little of tracks yet.
  const double limit = config_.filter.max_direction_deviation;
  return limit > 0 && baseline_.along > kKnownScale && baseline_.across < limit && state_.landmarks().empty();
}

void FilterEstimator::CorrectScale() {
  // While tracks wait for a better scale, corrections are large, and the gradient of second order in them
  // says nothing. The prior of the start is no part of the strain: its clones must have left.
  if (!carry_scale_ || baseline_.along > config_.filter.max_direction_deviation ||
      !state_.landmarks().empty() || serial_ - first_serial_ <= config_.filter.window) {
    return;
  }
  const double gradient = state_.strain().ScaleGradient();
  if (gradient == 0) {
    return;
  }
  scale_direction_.Descend(state_.covariance(), gradient, Correction());
  if (baseline_.along < kKnownShape) {
    if (std::abs(gradient) * baseline_.along < kLongestScaleStep) {
      Correct();
    }
  } else {
    scale_direction_.Inflate(Correction(), &state_);  // each step would make the next one longer
  }
}

}  // namespace alidade
