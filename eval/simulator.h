#pragma once

#include <string>

#include "core/config_schema.h"
#include "core/status.h"
#include "eval/dataset.h"

namespace alidade {

enum class SimTrajectory { kFigureEight, kEllipse };

/// A simulated sequence: analytic trajectory, IMU as its exact derivative, landmarks around the path, feature tracks.
struct SimulatorConfig {
  std::string name = "figure8";
  SimTrajectory trajectory = SimTrajectory::kFigureEight;
  double duration_s = 200;
  double length_m = 10;   ///< extent along x
  double width_m = 5;     ///< extent along y
  double height_m = 0.5;  ///< amplitude of the vertical motion
  double path_m = 262;    ///< total path length; sets the speed
  double rest_s = 0;      ///< at rest before the motion starts (smoothly)
  double imu_rate_hz = 100;
  double camera_rate_hz = 10;
  ImuNoise imu_noise;
  double gravity_mps2 = 9.81;
  double gyro_bias_radps = 0.005;   ///< standard deviation of the constant turn-on bias
  double accel_bias_mps2 = 0.05;
  int width_px = 752, height_px = 480;
  double focal_px = 460;
  double pixel_noise_px = 1;
  int max_features = 150;
  double mean_track_loss = 0.0;     ///< probability that a visible track is lost from one frame to the next
  double landmark_min_distance_m = 2, landmark_max_distance_m = 10;
  int landmark_count = 1500;

  void Describe(ConfigVisitor& visitor);
};

/// Same config and seed, same bytes. Truth has all 17 columns at the IMU rate.
Result<Dataset> Simulate(const SimulatorConfig& config, unsigned seed);

}  // namespace alidade
