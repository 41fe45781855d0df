#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/camera_model.h"
#include "core/config_schema.h"
#include "core/imu_sample.h"
#include "core/status.h"
#include "eval/simulation/render_config.h"
#include "eval/simulation/sim_motion_config.h"
#include "eval/simulation/sim_sensor_config.h"

namespace alidade {

enum class SimCameraView { kForward, kSideways, kDataset };
enum class SimLandmarkLayout {
  kShell,   ///< between two distances around the path
  kRoom,    ///< on floor, ceiling and walls of a box around the path
  kVolume,  ///< of even density in the space around the path
};
enum class SimOutlierKind {
  kJump,     ///< shifted by a vector: an observation, or a track from some frame on
  kUniform,  ///< anywhere in the image
  kSwap,     ///< ids exchanged: within one frame, or two tracks for the rest of their lives
  kDrift,    ///< a track slides away from its landmark at a constant rate
  kMoving,   ///< a track's landmark moves through the world at a constant velocity
  kMixed,    ///< each wrong track is one of the above
};
/// What fails at once, over fault_start_s and fault_duration_s (eval/simulation/sim_fault.h).
enum class SimFaultKind {
  kNone,
  kBlackout,  ///< the camera sees nothing, and all tracks end
  kImu,       ///< the IMU gives noise
  kTracks,    ///< the tracks of a frame exchange their ids at random
  kBlackoutAndImu,
  kFrozen,            ///< every frame repeats the first one of the fault
  kImuGap,            ///< the IMU is silent
  kGyroSpike,         ///< one sample
  kAccelSpike,        ///< one sample
  kGyroSaturation,    ///< each axis is clipped
  kAccelSaturation,   ///< each axis is clipped
  kGyroStuck,         ///< one axis repeats its last value
  kAccelStuck,        ///< one axis repeats its last value
  kGyroFrozen,        ///< all axes repeat their last values
  kImuFrozen,         ///< those of both sensors
  kImuUnit,           ///< the gyroscope is in deg/s from the start of the fault on
  kImuClock,          ///< the stamps of all later IMU samples are off
  kFrameDrops,        ///< some frames are missing
  kCameraClock,       ///< the stamps of all later frames are off
  kGnssRamp,          ///< GNSS and position fixes are pulled off ever farther, range rates with them
  kGnssRampNoRates,   ///< the same with true range rates
  kStaleEphemerides,  ///< the broadcast ephemerides of the sequence are a day old
  kGlare,             ///< rendered images: more light than the sensor holds
  kBlur,              ///< rendered images: out of focus
};
/// Whether single observations or whole tracks are wrong. Drift, moving and mixed outliers always affect
/// whole tracks.
enum class SimOutlierUnit { kObservation, kTrack };

/// A simulated sequence: trajectory (analytic or recorded), IMU as its exact derivative, landmarks around the
/// path, feature tracks. The noise defaults are those of the simulation in the Po-InVIO paper. With
/// hybrid_dataset only the tracks are simulated.
struct SimulatorConfig : SimMotionConfig, SimSensorConfig {
  std::string name = "figure8";
  int start_time_s = 1000;  ///< stamp of the first sample

  double imu_rate_hz = 100;
  double camera_rate_hz = 10;
  ImuNoise imu_noise;
  double gravity_mps2 = 9.81;
  double gyro_bias_radps = 0.005;  ///< standard deviation of the constant turn-on bias
  double accel_bias_mps2 = 0.05;
  double gyro_scale_std = 0;  ///< of each axis' scale factor less one; drawn once a seed
  double accel_scale_std = 0;
  double misalignment_std_rad = 0;  ///< of each of the six small angles between true and sensed axes

  SimCameraView camera_view = SimCameraView::kForward;
  Eigen::Vector3d camera_lever_arm_m = Eigen::Vector3d(0.10, -0.05, 0.04);  ///< p_BC
  double camera_time_offset_s = 0;                                          ///< t_imu = t_camera + offset
  int width_px = 752, height_px = 480;
  double focal_px = 460;
  DistortionModel distortion = DistortionModel::kNone;
  Eigen::Vector4d distortion_coefficients =
      Eigen::Vector4d::Zero();  ///< core/camera_model.h gives their order

  int camera_count = 1;  ///< 2: stereo
  /// From each camera to the next, in the frame of the former: x right, y down, z forward.
  Eigen::Vector3d camera_spacing_m = Eigen::Vector3d(0.11, 0, 0);
  double camera_turn_rad = 0;  ///< and turned to the right by this much

  double pixel_noise_px = 1;
  double noise_ratio_spread = 0;
  int max_features = 150;
  /// Probability that a visible track is lost from one frame to the next. Sets the mean length of tracks: p
  /// alone ends a track after 1 / p frames on average (0.125: 8 frames), leaving the view ends it earlier.
  double mean_track_loss = 0.0;
  double border_px = 10;
  double max_range_m = 30;
  double outlier_rate = 0;  ///< fraction of observations or of tracks
  SimOutlierKind outlier_kind = SimOutlierKind::kJump;
  SimOutlierUnit outlier_unit = SimOutlierUnit::kObservation;
  double outlier_px = 20;        ///< mean size of a jump; mean drift in one second
  double outlier_speed_mps = 1;  ///< mean speed of a moving landmark

  SimFaultKind fault = SimFaultKind::kNone;
  double fault_start_s = 20;  ///< after the first IMU sample
  double fault_duration_s = 3;
  double fault_drop_rate = 0.1;    ///< of frame_drops
  double fault_clock_jump_s = 1;   ///< of camera_clock and imu_clock
  double fault_limit_share = 0.5;  ///< of gyro_saturation and accel_saturation
  double fault_ramp_mps = 0.5;     ///< of gnss_ramp and gnss_ramp_no_rates
  double fault_blur_px = 6;        ///< of blur

  /// By how much the calibration that the estimators are given is wrong (eval/simulation/sim_calibration.h).
  double calibration_rotation_error_rad = 0;
  double calibration_translation_error_m = 0;
  double calibration_time_error_s = 0;
  double calibration_line_delay_error_s = 0;
  double calibration_focal_error_px = 0;
  double calibration_center_error_px = 0;
  double calibration_antenna_error_m = 0;

  SimLandmarkLayout landmark_layout = SimLandmarkLayout::kShell;
  double landmark_min_distance_m = 2;                        ///< of every landmark to the path
  double landmark_max_distance_m = 10;                       ///< shell
  int landmark_count = 800;                                  ///< shell and room
  double landmark_density_per_m3 = 0.2;                      ///< volume
  Eigen::Vector3d room_margin_m = Eigen::Vector3d(2, 2, 1);  ///< from the path's bounding box to the walls
  double room_depth_m = 0.5;  ///< landmarks stand out from their wall by up to this much

  RenderConfig render;

  [[nodiscard]] bool IsHybrid() const { return hybrid_dataset != kNoPath; }
  /// Whether outliers are whole tracks.
  [[nodiscard]] bool OutliersAreTracks() const;

  /// Lists every key with unit, range and reason; the order is the order of configs/datasets/figure8.yaml.
  void Describe(ConfigVisitor& visitor);
  /// Relations between keys that no single range can state, and values that no reader has checked.
  [[nodiscard]] Status Validate() const;
};

/// Reads a simulation config (ReadConfigFile), then applies settings "a.b=value", then validates. A relative
/// path in the file is taken from the file's own folder, one in a setting from the working folder. Errors
/// (kConfig) as ReadConfigFile.
Result<SimulatorConfig> LoadSimulatorConfig(const std::string& path,
                                            const std::vector<std::string>& settings);

}  // namespace alidade
