#pragma once

#include <string>

#include "core/config_schema.h"
#include "core/status.h"
#include "eval/dataset.h"

namespace alidade {

enum class SimTrajectory { kFigureEight, kEllipse };
enum class SimCameraView { kForward, kSideways };
enum class SimOutlierKind {
  kJump,   ///< a single observation lands elsewhere
  kDrift,  ///< a whole track slides away from its landmark at a constant rate
};

/// A simulated sequence: analytic trajectory, IMU as its exact derivative, landmarks around the path, feature
/// tracks. The noise defaults are those of the simulation in the Po-InVIO paper.
struct SimulatorConfig {
  std::string name = "figure8";
  int start_time_s = 1000;  ///< stamp of the first sample

  SimTrajectory trajectory = SimTrajectory::kFigureEight;
  double duration_s = 200;
  double length_m = 10;      ///< extent along x
  double width_m = 5;        ///< extent along y
  double height_m = 0.5;     ///< amplitude of the vertical motion
  double path_m = 262;       ///< total path length; sets the speed
  double rest_s = 0;         ///< at rest before the motion starts (smoothly)
  double rest_ramp_s = 2;    ///< from rest to full speed; no effect without rest
  double wobble_rad = 0.05;  ///< amplitude of the attitude about the path's tangent
  double wobble_hz = 0.3;

  double imu_rate_hz = 100;
  double camera_rate_hz = 10;
  ImuNoise imu_noise;
  double gravity_mps2 = 9.81;
  double gyro_bias_radps = 0.005;  ///< standard deviation of the constant turn-on bias
  double accel_bias_mps2 = 0.05;

  SimCameraView camera_view = SimCameraView::kForward;
  Eigen::Vector3d camera_lever_arm_m = Eigen::Vector3d(0.10, -0.05, 0.04);  ///< p_BC
  double camera_time_offset_s = 0;                                          ///< t_imu = t_camera + offset
  int width_px = 752, height_px = 480;
  double focal_px = 460;
  DistortionModel distortion = DistortionModel::kNone;
  Eigen::Vector4d distortion_coefficients =
      Eigen::Vector4d::Zero();  ///< core/camera_model.h gives their order

  double pixel_noise_px = 1;
  int max_features = 150;
  double mean_track_loss = 0.0;  ///< probability that a visible track is lost from one frame to the next
  double border_px = 10;
  double max_range_m = 30;
  double outlier_rate = 0;  ///< fraction of observations (jump) or of tracks (drift)
  SimOutlierKind outlier_kind = SimOutlierKind::kJump;
  double outlier_px = 20;  ///< mean size of a jump; mean drift in one second

  double landmark_min_distance_m = 2, landmark_max_distance_m = 10;
  int landmark_count = 800;

  /// Lists every key with unit, range and reason; the order is the order of configs/datasets/figure8.yaml.
  void Describe(ConfigVisitor& visitor);
  /// Relations between keys that no single range can state, and values that no reader has checked.
  [[nodiscard]] Status Validate() const;
};

/// Same config and seed, same bytes. Truth has all 17 columns at the IMU rate.
///
/// IMU: a_m = R^T (a - g) + b_a + n_a, w_m = w + b_g + n_g with g = (0, 0, -gravity_mps2), sampled at its
/// stamps; white noise n has the standard deviation density * sqrt(rate), a bias walks by random walk *
/// sqrt(1 / rate) a sample from a normal turn-on value. Camera: frames start at the first IMU stamp; a frame
/// shows the world at its stamp plus the time offset; an observation is the projection of its landmark plus
/// normal noise. Errors: those of Validate (kConfig).
Result<Dataset> Simulate(const SimulatorConfig& config, unsigned seed);

}  // namespace alidade
