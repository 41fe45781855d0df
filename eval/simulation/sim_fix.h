#pragma once

#include <cstdint>

#include "eval/dataset/dataset.h"
#include "eval/simulation/continuous_trajectory.h"
#include "eval/simulation/simulator_config.h"

namespace alidade {

/// Adds position fixes to a simulated sequence, if the configuration has them. Time 0 of the trajectory is
/// `start_ns` of IMU time; stamps lie on an even grid of the sensor's clock. Noise is white; a wrong fix is
/// displaced by a horizontal vector of uniform direction and size. Each fix draws the same numbers whatever
/// becomes of it: an outage or wrong fixes leave the noise of the others.
void AddSimulatedFixes(const SimulatorConfig& config, const ContinuousTrajectory& trajectory, TimeNs start_ns,
                       std::uint64_t seed, Dataset* dataset);

}  // namespace alidade
