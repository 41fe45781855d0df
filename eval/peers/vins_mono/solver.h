#pragma once

#include <vector>

#include "core/imu_sample.h"
#include "core/rig_calibration.h"
#include "eval/peers/vins_mono/tracker.h"
#include "eval/trajectory/trajectory.h"

namespace alidade::vins_mono {

struct SolverSettings {
  // Standard deviations of its midpoint integration's samples, not densities.
  double accel_noise = 0.08, gyro_noise = 0.004;  ///< [m/s^2, rad/s]
  double accel_walk = 4e-5, gyro_walk = 2e-6;     ///< [m/s^3, rad/s^2]
  double gravity_mps2 = 9.81007;
  int max_iterations = 8;
  double keyframe_parallax_px = 10;  ///< at a focal length of 460 px
  bool calibrate_extrinsics = false;
  bool calibrate_time_offset = false;
};

/// The samples' deviations that give its preintegration the covariance of white noise and walks of these
/// densities at `rate_hz`: of the noise, its two samples an interval weigh a half each, n = sigma sqrt(2
/// rate); of the walk n = sigma sqrt(rate).
void SetNoise(const ImuNoise& noise, double scale, double rate_hz, SolverSettings* settings);

/// VINS-Mono's solver: one object a process, since its settings are globals and it relies on its memory being
/// zero before its constructor runs.
class Solver {
 public:
  Solver(const RigCalibration& rig, const SolverSettings& settings);

  /// An IMU sample `step_s` after the one before.
  void AddImu(double step_s, const Eigen::Vector3d& gyro, const Eigen::Vector3d& accel);
  /// The features of the image at `time_s` of the camera's clock, to which the IMU has been delivered.
  void AddImage(const std::vector<Feature>& features, double time_s);

  /// Initialised and not lost.
  [[nodiscard]] bool running() const;
  [[nodiscard]] double time_offset_s() const;
  /// State of the newest image; no stamp and no covariance.
  [[nodiscard]] TrajectoryPoint Newest() const;
};

}  // namespace alidade::vins_mono
