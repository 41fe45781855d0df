#pragma once

#include <vector>

#include "core/estimator/estimator.h"
#include "smoother/window/window.h"

namespace alidade {

/// The smoother's part of measurements between frames. One is attached to the frame before it. It is gated
/// once, against the state that is predicted for its time, as in the filter: a refused one never
/// enters the window.
class MeasurementWindow {
 public:
  explicit MeasurementWindow(const EstimatorConfig& config) : gates_(config) {}

  /// Forgets what became of the measurements before.
  void Reset() { gates_.Reset(); }

  /// Hangs the measurement on the frame, unless the gate refuses it; `imu` leads there from the frame,
  /// `predicted` is the estimate at its time. False: refused.
  bool Attach(const WhitenedMeasurement& measurement, const NavEstimate& predicted,
              std::vector<ImuSample> imu, const ImuNoise& noise, WindowFrame* frame,
              FrameStatistics* statistics);

 private:
  /// The gate's weight.
  template <typename Kind>
  double WeighAndCount(const Kind& measurement, Sensor sensor, const NavEstimate& predicted,
                       SensorStatistics* counts);

  MeasurementGates gates_;
};

}  // namespace alidade
