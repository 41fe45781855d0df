#pragma once

#include "eval/dataset/dataset.h"

namespace alidade {

class Findings;

/// Calibrations that no rig has, of all cameras, the receiver and the position sensors: focal lengths,
/// principal point, lever arms and time offsets. Errors where no sensor on one body can be so, warnings where
/// it is unlikely.
void CheckRig(const Dataset& dataset, Findings* findings);

}  // namespace alidade
