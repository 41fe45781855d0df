#pragma once

#include "core/rig_calibration.h"
#include "core/vision_config.h"

namespace alidade {

/// The rig with its camera's observations on the chosen plane.
[[nodiscard]] RigCalibration OnPlane(const RigCalibration& rig, PlaneChoice choice);

}  // namespace alidade
