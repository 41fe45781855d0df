#pragma once

#include "core/imu_sample.h"

namespace alidade {

/// What the solvers of VINS-Mono and GVINS are set to; the defaults are VINS-Mono's published ones for EuRoC.
struct VinsSettings {
  // Standard deviations of their midpoint integration's samples, not densities.
  double accel_noise = 0.08, gyro_noise = 0.004;  ///< [m/s^2, rad/s]
  double accel_walk = 4e-5, gyro_walk = 2e-6;     ///< [m/s^3, rad/s^2]
  double gravity_mps2 = 9.81007;
  int max_iterations = 8;
  bool real_time = false;            ///< wall time may end a solve
  double keyframe_parallax_px = 10;  ///< at a focal length of 460 px
  bool calibrate_extrinsics = false;
  bool calibrate_time_offset = false;
};

/// The samples' deviations that give their preintegration the covariance of white noise and walks of these
/// densities at `rate_hz`: of the noise, its two samples an interval weigh a half each, n = sigma sqrt(2
/// rate); of the walk n = sigma sqrt(rate).
void SetVinsNoise(const ImuNoise& noise, double scale, double rate_hz, VinsSettings* settings);

}  // namespace alidade
