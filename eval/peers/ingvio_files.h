#pragma once

#include <string>

#include "core/rig_calibration.h"
#include "core/status.h"

namespace alidade {

/// What InGVIO is set to; the defaults are its published ones for its own sensor (configuration
/// `sportsfield`).
struct IngvioSettings {
  // Densities [rad/s/sqrt(Hz), m/s^2/sqrt(Hz), rad/s^2/sqrt(Hz), m/s^3/sqrt(Hz)].
  double gyro_noise = 0.004, accel_noise = 0.08;
  double gyro_walk = 0.0002, accel_walk = 0.008;
  double visual_noise = 0.18;  ///< on the normalised plane
  double gravity_mps2 = 9.8;   ///< that the mean of a start at rest has to have within 2 %
  int clones = 35;
  int max_features = 150;
  int start_samples = 300;  ///< of the IMU, at rest
  bool gnss = true;
  bool gnss_gate = false;
  double elevation_deg = 20;
  int min_tracked_epochs = 20;
  int align_epochs = 45;
  bool estimate_yaw = false;     ///< of the local world, once aligned
  double local_less_gpst_s = 0;  ///< its clock less gnss_comm's seconds
  double extrinsic_rotation_std = 0.018, extrinsic_position_std_m = 0.002;
};

/// InGVIO's camera file: lens and extrinsics of the sheet, its tracker's settings. kInput: a lens model that
/// it has not.
Result<std::string> IngvioCameraFile(const RigCalibration& rig, const IngvioSettings& settings);

/// InGVIO's file, which names the camera's.
std::string IngvioFile(const IngvioSettings& settings, const std::string& camera_file);

}  // namespace alidade
