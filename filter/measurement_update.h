#pragma once

#include "core/estimator/estimator.h"
#include "filter/filter_state.h"

namespace alidade {

/// The filter's part of measurements between frames: update with one at the state's stamp.
class MeasurementUpdate {
 public:
  explicit MeasurementUpdate(const EstimatorConfig& config) : gates_(config) {}

  /// Null, the default, observes nothing. It must outlive the object.
  void SetObserver(FilterObserver* observer) { observer_ = observer; }
  /// Forgets what became of the measurements before.
  void Reset() { gates_.Reset(); }

  /// Updates the covariance; `correction` (the error's dimension) is what the caller then corrects the state
  /// by. False when a number is not finite.
  bool Apply(const WhitenedMeasurement& measurement, FilterState* state,
             Eigen::Ref<Eigen::VectorXd> correction, FrameStatistics* statistics);

 private:
  MeasurementGates gates_;
  FilterObserver* observer_ = nullptr;
};

}  // namespace alidade
