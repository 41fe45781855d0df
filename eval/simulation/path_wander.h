#pragma once

#include <cstdint>
#include <memory>

#include "eval/simulation/path_shape.h"
#include "eval/simulation/simulator_config.h"

namespace alidade {

/// The paths that are drawn from a seed; sim_trajectory.h states the equations.
[[nodiscard]] std::unique_ptr<PathShape> MakeWander(const SimulatorConfig& config, std::uint64_t seed);
[[nodiscard]] std::unique_ptr<PathShape> MakeHover(const SimulatorConfig& config, std::uint64_t seed);
[[nodiscard]] std::unique_ptr<PathShape> MakeRotation(const SimulatorConfig& config, std::uint64_t seed);

}  // namespace alidade
