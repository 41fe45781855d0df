#pragma once

#include <vector>

#include "core/estimator/estimator.h"
#include "core/position_fix.h"
#include "smoother/window/window.h"

namespace alidade {

/// The smoother's part of position fixes. A fix hangs on the frame before it. It is judged once, against the
/// state that is predicted for its time, as the filter judges it: a refused fix never enters the window.
class FixWindow {
 public:
  FixWindow(const FixConfig& config, std::vector<FixSensor> sensors);

  /// Forgets what became of the fixes before.
  void Reset() { gate_.Reset(); }

  /// See MakeFixMeasurement.
  [[nodiscard]] Result<FixMeasurement> Prepare(const PositionFix& fix) const {
    return MakeFixMeasurement(config_, sensors_, fix);
  }
  /// Hangs the fix on the frame, unless the gate refuses it; `imu` leads there from the frame, `predicted` is
  /// the estimate at its time.
  void Attach(const FixMeasurement& fix, const NavEstimate& predicted, std::vector<ImuSample> imu,
              const ImuNoise& noise, WindowFrame* frame, FrameStatistics* statistics);

 private:
  FixConfig config_;
  std::vector<FixSensor> sensors_;
  FixGate gate_;
};

}  // namespace alidade
