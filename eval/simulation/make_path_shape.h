#pragma once

#include <cstdint>
#include <memory>

#include "eval/simulation/path_shape.h"
#include "eval/simulation/simulator_config.h"

namespace alidade {

/// The curve that config.trajectory names; sim_trajectory.h states the equations. `seed` matters to wander,
/// hover and rotation alone. Precondition: the trajectory is an analytic one.
[[nodiscard]] std::unique_ptr<PathShape> MakePathShape(const SimulatorConfig& config, std::uint64_t seed);

}  // namespace alidade
