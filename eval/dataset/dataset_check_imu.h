#pragma once

#include "eval/dataset/dataset.h"

namespace alidade {

class Findings;

/// Of the IMU: unit of the stamps, rate, gaps, units of the values, exchanged columns, dead axes, repeated
/// values, gravity at rest, noise densities.
void CheckImu(const Dataset& dataset, Findings* findings);

}  // namespace alidade
