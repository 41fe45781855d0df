#pragma once

#include "core/estimator/measurement.h"
#include "smoother/window/imu_link.h"

namespace alidade {

/// A measurement between frames that is attached to a frame of the window. Its noise contains the weight that
/// the gate gave it.
struct FrameMeasurement : ImuLink {
  WhitenedMeasurement measurement;

  void ScaleSqrtInformation(double root) {
    std::visit([&](auto& kind) { kind.ScaleSqrtInformation(root); }, measurement);
  }
};

}  // namespace alidade
