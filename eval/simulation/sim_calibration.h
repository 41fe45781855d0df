#pragma once

#include <cstdint>

#include "core/rig_calibration.h"
#include "eval/simulation/simulator_config.h"

namespace alidade {

/// A calibration that is wrong by as much as the configuration's calibration_*_error keys: axis,
/// direction and signs are drawn with the seed, each from its own fixed place. Intrinsics that no camera has:
/// kConfig.
Result<RigCalibration> MiscalibratedRig(const SimulatorConfig& config, const RigCalibration& rig,
                                        std::uint64_t seed);

}  // namespace alidade
