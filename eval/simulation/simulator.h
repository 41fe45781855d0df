#pragma once

#include "core/status.h"
#include "eval/simulation/simulation.h"
#include "eval/simulation/simulator_config.h"

namespace alidade {

/// Same config and seed, same bytes (and same recording, where one is used).
///
/// IMU: a_m = M_a R^T (a - g) + b_a + n_a, w_m = M_g w + b_g + n_g with g = (0, 0, -gravity_mps2), sampled at
/// its stamps; white noise n has the standard deviation density * sqrt(rate), a bias walks by random walk *
/// sqrt(1 / rate) a sample from a normal turn-on value; M = I + scale errors on and misalignment off the
/// diagonal, constant. Camera: frames start at the first IMU stamp; a frame shows the world at its stamp plus
/// the time offset; an observation is the projection of its landmark plus normal noise; faults of tracks:
/// sim_fault.h; several cameras: sim_camera.h. Truth has all 17 columns at the IMU rate. Every effect draws
/// from streams of its own, and what is drawn for a landmark in a frame does not depend on what happens to
/// others: switching one effect on leaves the numbers of the others.
///
/// trajectory: file moves the body along a spline through a recorded trajectory (recorded_motion.h), stamped
/// as the recording, for at most duration_s. hybrid_dataset simulates the tracks alone (sim_hybrid.h). With
/// render.enabled there are camera stamps and no tracks: they come from images (rendered_sequence.h).
/// Errors: those of Validate (kConfig); a recording that cannot be read or used (kInput).
Result<Simulation> SimulateWithMotion(const SimulatorConfig& config, unsigned seed);
/// The sequence alone.
Result<Dataset> Simulate(const SimulatorConfig& config, unsigned seed);

}  // namespace alidade
