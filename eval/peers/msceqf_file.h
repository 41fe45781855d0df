#pragma once

#include <string>

#include "core/rig_calibration.h"
#include "core/status.h"

namespace alidade {

/// What MSCEqF is set to; the defaults are its published ones for EuRoC.
struct MsceqfSettings {
  // Densities [rad/s/sqrt(Hz), m/s^2/sqrt(Hz), rad/s^2/sqrt(Hz), m/s^3/sqrt(Hz)].
  double gyro_noise = 1.6968e-4, accel_noise = 2e-3;
  double gyro_walk = 1.9393e-5, accel_walk = 3e-3;
  double pixel_noise_px = 1;
  double gravity_mps2 = 9.81;
  int clones = 11;
  int max_features = 100;
  /// Of the camera's pose on the body, which it always estimates: of the rotation [rad], the position [m].
  double extrinsics_std = 0.03;
};

/// MSCEqF's file: lens, extrinsics and time offset of the sheet, and the settings. kInput: a lens model that
/// it has not.
Result<std::string> MsceqfFile(const RigCalibration& rig, const MsceqfSettings& settings);

}  // namespace alidade
