#pragma once

#include <string>

#include "core/config_schema.h"
#include "core/error_convention.h"
#include "core/fix_config.h"
#include "core/gnss_config.h"
#include "core/imu_sample.h"
#include "core/status.h"

namespace alidade {

enum class Backend { kFilter, kSmoother, kBatch };

/// Noise, gates and kernels of vision; shared by both back ends so that a comparison compares estimators, not
/// settings.
struct VisionConfig {
  double pixel_noise_px = 1.0;
  double gate_probability = 0.99;
  double max_gated_share = 0.5;
  double max_relative_depth_deviation = 0.1;
  double min_depth_m = 0.1;
  double max_depth_m = 300.0;
  RobustKernel robust_kernel = RobustKernel::kHuber;
  double robust_scale_sigma = 2.0;
  // Standing still (core/rest_detector.h).
  bool rest_updates = true;
  double rest_window_s = 0.5;
  double rest_max_flow_px = 1.0;
  double rest_max_accel_std_mps2 = 1.0;
  double rest_velocity_std_mps = 0.02;
  double rest_rate_std_radps = 0.005;

  void Describe(ConfigVisitor& visitor);
};

/// Gravity and how far the sensor sheet's noise is trusted.
struct ImuConfig {
  double gravity_mps2 = 9.81;
  double noise_scale = 1.0;
  double random_walk_scale = 1.0;
  double max_gap_s = 0.5;

  /// The sensor sheet's noise as far as it is trusted.
  [[nodiscard]] ImuNoise Scaled(const ImuNoise& sheet) const;
  void Describe(ConfigVisitor& visitor);
};

enum class InitMethod { kTruth, kStatic, kDynamic, kAuto };

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
  double dynamic_window_s = 2.0;
  int dynamic_min_frames = 6;
  double dynamic_min_parallax_px = 20.0;
  double max_wait_s = 30.0;

  void Describe(ConfigVisitor& visitor);
};

struct FrontendConfig {
  int max_features = 150;
  double min_distance_px = 20.0;
  int grid_columns = 8;
  int grid_rows = 5;
  double corner_threshold = 12.0;
  int pyramid_levels = 3;
  int window_px = 15;
  int template_px = 13;
  double min_correlation = 0.8;
  double ransac_threshold_px = 1.0;
  double forward_backward_px = 0.0;
  bool equalize = true;
  bool imu_prediction = true;

  void Describe(ConfigVisitor& visitor);
};

enum class FilterLandmark { kPoseOnlyMulti, kPoseOnlyTwo, kMsckf };
enum class UpdateTiming { kImmediate, kDelayedAll, kAtL };
/// What happens to the base observation after an immediate update (docs/pose_only.md).
enum class BaseReuse {
  kPaper,     ///< re-used with its plain noise: double counts, as the paper writes it
  kInflate,   ///< re-used with its standard deviation scaled by base_inflation
  kLimit,     ///< at most max_base_rounds rounds a base
  kDisjoint,  ///< never re-used: a new base each round
};
enum class ClonePolicy { kOldest, kKeepBases, kAlternate };
/// What an immediate update keeps of the landmark (docs/pose_only.md).
enum class TrackMemoryPolicy {
  kNone,    ///< nothing but the base observation, see BaseReuse
  kWindow,  ///< its three rows, until a clone in them leaves
  kCarry,   ///< its three rows, carried past the window
};

struct FilterConfig {
  ErrorConvention error = ErrorConvention::kRightInvariant;
  FilterLandmark landmark = FilterLandmark::kPoseOnlyMulti;
  UpdateTiming update = UpdateTiming::kImmediate;
  int min_observations = 4;
  int window = 25;
  BaseReuse base_reuse = BaseReuse::kInflate;
  double base_inflation = 2.0;
  int max_base_rounds = 2;
  TrackMemoryPolicy track_memory = TrackMemoryPolicy::kNone;
  double memory_depth_deviation = 0.015;
  bool flush_lost_tracks = true;
  ClonePolicy clone_policy = ClonePolicy::kKeepBases;
  int refine_iterations = 5;
  bool first_estimates = false;
  int slam_features = 0;
  int slam_min_track = 10;
  double slam_max_depth_deviation = 0.05;

  void Describe(ConfigVisitor& visitor);
};

enum class SmootherLandmark { kPoseOnly, kInverseDepth };
enum class FramePolicy { kKeyframes, kEveryFrame };

struct SmootherConfig {
  ErrorConvention error = ErrorConvention::kRightInvariant;
  SmootherLandmark landmark = SmootherLandmark::kInverseDepth;
  int window = 10;
  int max_iterations = 8;
  FramePolicy frames = FramePolicy::kKeyframes;
  double keyframe_parallax_px = 10.0;
  int keyframe_min_tracked = 20;
  int max_landmarks = 150;
  int slam_features = 0;
  bool first_estimates = false;

  void Describe(ConfigVisitor& visitor);
};

/// Which parameters of the camera are estimated along with the motion (core/calibration.h). The standard
/// deviations say how far the given calibration is trusted, one for each axis or coefficient.
struct CalibrationConfig {
  bool extrinsics = false;
  bool time_offset = false;
  bool intrinsics = false;
  double rotation_std_rad = 0.035;
  double translation_std_m = 0.03;
  double time_offset_std_s = 0.01;
  double focal_std_px = 5.0;
  double center_std_px = 5.0;
  double distortion_std = 0.02;

  [[nodiscard]] bool any() const { return extrinsics || time_offset || intrinsics; }
  void Describe(ConfigVisitor& visitor);
};

/// When an estimate is given up and a new start is sought; shared by both back ends.
struct RecoveryConfig {
  bool enabled = true;
  double max_speed_mps = 100.0;
  double max_gyro_bias_radps = 1.0;
  double max_accel_bias_mps2 = 5.0;
  double max_suspect_s = 3.0;

  void Describe(ConfigVisitor& visitor);
};

/// Whose run gives the batch estimate its initial values; it is set by its own section.
enum class BatchInitial { kFilter, kSmoother };

struct BatchConfig {
  BatchInitial initial = BatchInitial::kFilter;
  int max_iterations = 50;
  double tolerance_sigma = 0.01;
  RobustKernel robust_kernel = RobustKernel::kNone;
  double gate_probability = 0.9999;
  bool filtering_bound = true;

  void Describe(ConfigVisitor& visitor);
};

/// Everything that turns a measurement log into a trajectory. One per estimator of a comparison.
struct EstimatorConfig {
  std::string name = "unnamed";
  Backend backend = Backend::kFilter;
  VisionConfig vision;
  ImuConfig imu;
  InitConfig init;
  FrontendConfig frontend;
  FilterConfig filter;
  SmootherConfig smoother;
  BatchConfig batch;
  CalibrationConfig calibration;
  RecoveryConfig recovery;
  GnssConfig gnss;
  FixConfig fix;

  /// Lists every key with unit, range and reason; the order is the order of configs/base.yaml.
  void Describe(ConfigVisitor& visitor);
  /// Relations between keys that no single range can state.
  [[nodiscard]] Status Validate() const;
};

}  // namespace alidade
