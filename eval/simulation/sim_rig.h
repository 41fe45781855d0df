#pragma once

#include <vector>

#include "core/estimator/measurement_log.h"
#include "eval/simulation/simulator_config.h"

namespace alidade {

/// The simulated rig: camera model, T_BC, IMU noise and camera time offset, all exactly known to the
/// estimators. camera_view: dataset takes camera model, T_BC and time offset from cam0/sensor.yaml of the
/// dataset folder in trajectory_file. Errors: a lens model that CameraModel::Create refuses (kConfig), a
/// folder without calibration (kInput).
Result<RigCalibration> MakeSimRig(const SimulatorConfig& config);

/// Line delay of the simulated camera: render.line_delay_s, or that of the recording's camera where the key
/// is zero.
[[nodiscard]] double SimLineDelay(const SimulatorConfig& config, double recorded_s);

/// The other camera_count - 1 cameras, without frames: each of the same model as the first, displaced and
/// turned against the one before it: T_BCk = T_BC(k-1) * (Exp(camera_turn_rad e_y), camera_spacing_m).
[[nodiscard]] std::vector<ExtraCamera> MakeExtraCameras(const SimulatorConfig& config,
                                                        const RigCalibration& rig);

}  // namespace alidade
