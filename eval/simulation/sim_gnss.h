#pragma once

#include <cstdint>

#include "core/status.h"
#include "eval/dataset/dataset.h"
#include "eval/simulation/continuous_trajectory.h"
#include "eval/simulation/simulator_config.h"

namespace alidade {

/// Adds a GNSS receiver to a simulated sequence: observations, navigation data, antenna. Time 0 of the
/// trajectory is `start_ns` of IMU time; epochs carry tags on an even grid of the receiver's clock.
///
/// Code: geometric range in axes that stand still, satellite and receiver clocks, bias of the system, group
/// delay, ionosphere, troposphere, then multipath (first-order Gauss-Markov), reflection, white noise.
/// Doppler: the difference of noise-free codes over 10 ms, and white noise. Values are rounded as RINEX
/// writes them. With the fault stale_ephemerides the sequence has the navigation data of the day before,
/// which are those of the same satellites. Every satellite and effect draws from a stream of its own. Errors
/// (kInput): the navigation file, or no satellite is ever seen.
Status AddSimulatedGnss(const SimulatorConfig& config, const ContinuousTrajectory& trajectory,
                        TimeNs start_ns, std::uint64_t seed, Dataset* dataset);

}  // namespace alidade
