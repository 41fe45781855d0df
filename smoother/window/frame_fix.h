#pragma once

#include <optional>
#include <vector>

#include "core/position_fix.h"
#include "core/preintegration.h"

namespace alidade {

/// A position fix attached to a frame of the window: the IMU carries the frame's state on to it. Over the
/// tenths of a second between them the IMU's noise (millimetres) is left out.
struct FrameFix {
  TimeNs stamp_ns = 0;
  FixMeasurement measurement;
  std::vector<ImuSample> imu;  ///< from the frame to the fix; empty at the frame itself
  std::optional<Preintegration> preintegration;
  /// Of the information, as FixGate says; 0: refused.
  double weight = 1;
  bool counted = false;  ///< in the statistics
};

}  // namespace alidade
