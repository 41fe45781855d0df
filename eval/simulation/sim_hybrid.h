#pragma once

#include "core/status.h"
#include "eval/simulation/simulation.h"
#include "eval/simulation/simulator_config.h"

namespace alidade {

/// Real IMU, simulated tracks: the dataset folder config.hybrid_dataset with its own IMU samples, noise
/// sheet, camera calibration and camera stamps, but tracks of landmarks simulated along its ground truth.
/// Tests back ends on the noise, vibration and bias of a real sensor without depending on a front end.
///
/// Motion: spline through the truth (recorded_motion.h: the recomputed truth where there is one; the longest
/// stretch without gaps, at most duration_s of it). Frames: the camera stamps whose exposure (stamp + time
/// offset) lies within that stretch and within the IMU samples; before it, where EuRoC's truth is missing
/// with the vehicle at rest, there are none. IMU: from 3 s before the first frame (a rest there serves static
/// initialisation) to the first sample after the last exposure. Truth: the recorded rows of the stretch.
/// A refined truth (recorded_motion.h) shares the vibration of the IMU with the camera; its covariances are
/// left out, for the camera moves along it exactly. Keys of trajectory, IMU, camera rate and camera model
/// have no effect; those of tracks and landmarks do.
///
/// Errors: those of ReadDataset and LoadRecordedMotion; no truth, no frames, a motion that the gyroscope
/// contradicts (kInput); no room for landmarks (kConfig).
Result<Simulation> SimulateHybrid(const SimulatorConfig& config, unsigned seed);

}  // namespace alidade
