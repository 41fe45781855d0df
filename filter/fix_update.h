#pragma once

#include <vector>

#include "core/estimator/estimator.h"
#include "core/position_fix.h"
#include "filter/filter_state.h"

namespace alidade {

/// The filter's part of position fixes: update with a fix at the state's stamp.
class FixUpdate {
 public:
  FixUpdate(const FixConfig& config, std::vector<FixSensor> sensors);

  /// Null, the default, observes nothing. It must outlive the object.
  void SetObserver(FilterObserver* observer) { observer_ = observer; }
  /// Forgets what became of the fixes before.
  void Reset() { gate_.Reset(); }

  /// See MakeFixMeasurement.
  [[nodiscard]] Result<FixMeasurement> Prepare(const PositionFix& fix) const {
    return MakeFixMeasurement(config_, sensors_, fix);
  }
  /// Updates the covariance; `correction` (the error's dimension) is what the caller then corrects the state
  /// by. False when a number is not finite.
  bool Apply(const FixMeasurement& fix, FilterState* state, Eigen::Ref<Eigen::VectorXd> correction,
             FrameStatistics* statistics);

 private:
  FixConfig config_;
  std::vector<FixSensor> sensors_;
  FixGate gate_;
  FilterObserver* observer_ = nullptr;
};

}  // namespace alidade
