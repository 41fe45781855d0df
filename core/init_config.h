#pragma once

#include "core/config_schema.h"

namespace alidade {

enum class InitMethod { kTruth, kStatic, kDynamic, kAuto };

/// Prior, and detection of rest or motion, of the initialisation; shared by both back ends.
struct InitConfig {
  InitMethod method = InitMethod::kAuto;
  // Prior standard deviations, isotropic.
  double tilt_std_rad = 0.01;
  double yaw_std_rad = 1e-3;
  double position_std_m = 1e-3;
  double velocity_std_mps = 0.05;
  double gyro_bias_std_radps = 5e-3;
  double accel_bias_std_mps2 = 0.1;
  bool perturb_truth = true;
  // At rest.
  double static_window_s = 1.0;
  double static_max_gyro_std_radps = 0.03;
  double static_max_accel_std_mps2 = 0.3;
  double static_max_parallax_px = 1.0;
  // In motion.
  double dynamic_window_s = 1.6;
  int dynamic_min_frames = 6;
  double dynamic_min_parallax_px = 5.0;
  double max_wait_s = 30.0;

  void Describe(ConfigVisitor& visitor);
};

}  // namespace alidade
