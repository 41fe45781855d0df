#pragma once

#include "core/position_fix.h"
#include "smoother/window/imu_link.h"

namespace alidade {

/// A position fix that hangs on a frame of the window. Its noise contains the weight that FixGate gave it.
struct FrameFix : ImuLink {
  FixMeasurement measurement;
};

}  // namespace alidade
