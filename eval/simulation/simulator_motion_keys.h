#pragma once

#include "eval/simulation/simulator_config.h"

namespace alidade {

/// The part of SimulatorConfig::Describe about the motion, analytic or recorded.
void DescribeMotionKeys(SimulatorConfig* config, ConfigVisitor& visitor);

}  // namespace alidade
