#include "core/estimator_config.h"

namespace alidade {

void VisionConfig::Describe(ConfigVisitor& visitor) {
  visitor.Real({"pixel_noise_px", "px", "standard deviation of one image coordinate of a track"},
               &pixel_noise_px, 0.01, 100);
  visitor.Real({"gate_probability", "-",
                "a track is used if its innovation lies in this chi-square quantile; 1 opens the gate"},
               &gate_probability, 0.5, 1.0);
  visitor.Real({"max_gated_share", "-",
                "when the gate refuses more, the state is suspect and not the tracks: all are used, "
                "down-weighted to the gate"},
               &max_gated_share, 0, 1);
  visitor.Real(
      {"max_relative_depth_deviation", "-",
       "parallax gate: a track waits until its depth is known this well; linearisation fails above 0.05"},
      &max_relative_depth_deviation, 1e-4, 10);
  visitor.Real({"min_depth_m", "m", "nearer landmarks are mismatches"}, &min_depth_m, 1e-3, 100);
  visitor.Real({"max_depth_m", "m", "farther landmarks carry no translation"}, &max_depth_m, 1, 1e5);
  visitor.Enumeration(
      {"robust_kernel", "-", "down-weights what the gate lets pass"}, &robust_kernel,
      {{"none", RobustKernel::kNone}, {"huber", RobustKernel::kHuber}, {"cauchy", RobustKernel::kCauchy}});
  visitor.Real({"robust_scale_sigma", "sigma", "whitened residual norm at which the kernel sets in"},
               &robust_scale_sigma, 0.1, 1e3);
  visitor.Boolean({"rest_updates", "-",
                   "standing still is a measurement of zero velocity; tracks without parallax say nothing"},
                  &rest_updates);
  visitor.Real({"rest_window_s", "s", "rest must last this long before it counts"}, &rest_window_s, 0.1, 10);
  visitor.Real({"rest_max_flow_px", "px", "image flow over the window that is still rest"}, &rest_max_flow_px,
               0.01, 20);
  visitor.Real({"rest_max_accel_std_mps2", "m/s^2",
                "spread of specific force that is still rest; running rotors shake"},
               &rest_max_accel_std_mps2, 1e-3, 20);
  visitor.Real({"rest_velocity_std_mps", "m/s", "trust in zero velocity at rest"}, &rest_velocity_std_mps,
               1e-5, 1);
  visitor.Real({"rest_rate_std_radps", "rad/s", "trust in zero angular rate at rest"}, &rest_rate_std_radps,
               1e-6, 1);
}

void ImuConfig::Describe(ConfigVisitor& visitor) {
  visitor.Real({"gravity_mps2", "m/s^2", "magnitude; W has z up"}, &gravity_mps2, 9.7, 9.9);
  visitor.Real({"noise_scale", "-",
                "multiplies the sensor sheet's white-noise densities; sheets are optimistic in flight"},
               &noise_scale, 0.1, 1000);
  visitor.Real({"random_walk_scale", "-", "multiplies the sensor sheet's bias random walks"},
               &random_walk_scale, 0.01, 1000);
  visitor.Real({"max_gap_s", "s", "a longer silence of the IMU is reported as a gap"}, &max_gap_s, 0.01, 10);
}

ImuNoise ImuConfig::Scaled(const ImuNoise& sheet) const {
  return {sheet.gyro_noise_density_radps_sqrthz * noise_scale,
          sheet.accel_noise_density_mps2_sqrthz * noise_scale,
          sheet.gyro_random_walk_radps2_sqrthz * random_walk_scale,
          sheet.accel_random_walk_mps3_sqrthz * random_walk_scale};
}

void InitConfig::Describe(ConfigVisitor& visitor) {
  visitor.Enumeration(
      {"method", "-", "truth needs ground truth (simulation); auto takes static at rest, else dynamic"},
      &method,
      {{"truth", InitMethod::kTruth},
       {"static", InitMethod::kStatic},
       {"dynamic", InitMethod::kDynamic},
       {"auto", InitMethod::kAuto}});
  visitor.Real({"tilt_std_rad", "rad", "prior of roll and pitch"}, &tilt_std_rad, 1e-6, 1);
  visitor.Real({"yaw_std_rad", "rad", "prior of yaw; unobservable, so it stays in every later covariance"},
               &yaw_std_rad, 1e-6, 4);
  visitor.Real({"position_std_m", "m", "prior of position; unobservable as yaw is"}, &position_std_m, 1e-6,
               100);
  visitor.Real({"velocity_std_mps", "m/s", "prior of velocity"}, &velocity_std_mps, 1e-6, 100);
  visitor.Real({"gyro_bias_std_radps", "rad/s", "prior of the gyroscope bias"}, &gyro_bias_std_radps, 1e-7,
               1);
  visitor.Real({"accel_bias_std_mps2", "m/s^2", "prior of the accelerometer bias"}, &accel_bias_std_mps2,
               1e-6, 5);
  visitor.Boolean({"perturb_truth", "-",
                   "method truth draws the start from the prior, else the first NEES would be zero"},
                  &perturb_truth);
  visitor.Real({"static_window_s", "s", "rest needed for gravity and gyroscope bias"}, &static_window_s, 0.1,
               60);
  visitor.Real({"static_max_gyro_std_radps", "rad/s", "more is motion"}, &static_max_gyro_std_radps, 1e-5, 1);
  visitor.Real({"static_max_accel_std_mps2", "m/s^2", "more is motion"}, &static_max_accel_std_mps2, 1e-4,
               10);
  visitor.Real({"static_max_parallax_px", "px",
                "mean track motion over the window; more is motion at constant velocity"},
               &static_max_parallax_px, 0.01, 100);
  visitor.Real({"dynamic_window_s", "s", "data the dynamic initialisation works on"}, &dynamic_window_s, 0.5,
               20);
  visitor.Integer({"dynamic_min_frames", "-", "fewer frames do not determine velocity, gravity and scale"},
                  &dynamic_min_frames, 4, 100);
  visitor.Real({"dynamic_min_parallax_px", "px",
                "mean track motion over the window; less leaves the scale unobservable"},
               &dynamic_min_parallax_px, 1, 500);
  visitor.Real({"max_wait_s", "s", "no initial state after this long ends the run with a reason"},
               &max_wait_s, 1, 1e5);
}

void FrontendConfig::Describe(ConfigVisitor& visitor) {
  visitor.Integer({"max_features", "-", "tracks kept alive in an image"}, &max_features, 10, 2000);
  visitor.Real({"min_distance_px", "px", "between two tracks"}, &min_distance_px, 1, 200);
  visitor.Integer({"grid_columns", "-", "corners are detected per cell so that they spread over the image"},
                  &grid_columns, 1, 64);
  visitor.Integer({"grid_rows", "-", "see grid_columns"}, &grid_rows, 1, 64);
  visitor.Real({"corner_threshold", "grey", "FAST contrast below which a corner is not tracked"},
               &corner_threshold, 1, 200);
  visitor.Integer({"pyramid_levels", "-", "levels above the full image"}, &pyramid_levels, 0, 6);
  visitor.Integer({"window_px", "px", "side of the KLT patch; a larger one feels how the image deforms"},
                  &window_px, 5, 61);
  visitor.Integer(
      {"template_px", "px",
       "side of the patch kept of a track's first image; every image is matched to it under an affine "
       "deformation, so that the track does not slide off its corner; 0 goes from frame to frame alone"},
      &template_px, 0, 41);
  visitor.Real({"min_correlation", "-", "of the image with that patch; less ends the track"},
               &min_correlation, 0, 1);
  visitor.Real({"ransac_threshold_px", "px", "distance to the epipolar line"}, &ransac_threshold_px, 0.1, 20);
  visitor.Real({"forward_backward_px", "px",
                "a track must come back this close from frame to frame; 0 skips the backward pass"},
               &forward_backward_px, 0, 10);
  visitor.Boolean({"equalize", "-", "CLAHE before tracking; steadies exposure changes"}, &equalize);
  visitor.Boolean({"imu_prediction", "-", "start each track where the gyroscope says it is"},
                  &imu_prediction);
}

void FilterConfig::Describe(ConfigVisitor& visitor) {
  visitor.Enumeration({"error", "-", "error convention of the state"}, &error,
                      {{"right_invariant", ErrorConvention::kRightInvariant},
                       {"left_invariant", ErrorConvention::kLeftInvariant},
                       {"so3xrn", ErrorConvention::kSo3xRn}});
  visitor.Enumeration({"landmark", "-", "how a track's depth is found at its linearisation point"}, &landmark,
                      {{"pose_only_multi", FilterLandmark::kPoseOnlyMulti},
                       {"pose_only_two", FilterLandmark::kPoseOnlyTwo},
                       {"msckf", FilterLandmark::kMsckf}});
  visitor.Enumeration({"update", "-", "when a track updates the state"}, &update,
                      {{"immediate", UpdateTiming::kImmediate},
                       {"delayed_all", UpdateTiming::kDelayedAll},
                       {"at_l", UpdateTiming::kAtL}});
  visitor.Integer({"min_observations", "-", "views a track needs for an update; L of the paper"},
                  &min_observations, 2, 100);
  visitor.Integer({"window", "-", "clones kept"}, &window, 3, 200);
  visitor.Enumeration({"base_reuse", "-", "what happens to the base observation after an immediate update"},
                      &base_reuse,
                      {{"paper", BaseReuse::kPaper},
                       {"inflate", BaseReuse::kInflate},
                       {"limit", BaseReuse::kLimit},
                       {"disjoint", BaseReuse::kDisjoint}});
  visitor.Real({"base_inflation", "-", "factor on a re-used base's standard deviation"}, &base_inflation, 1,
               100);
  visitor.Integer({"max_base_rounds", "-", "rounds a base may serve when base_reuse is limit"},
                  &max_base_rounds, 1, 1000);
  visitor.Enumeration({"track_memory", "-", "what an update keeps of the landmark; replaces base_reuse"},
                      &track_memory,
                      {{"none", TrackMemoryPolicy::kNone},
                       {"window", TrackMemoryPolicy::kWindow},
                       {"carry", TrackMemoryPolicy::kCarry}});
  visitor.Real({"memory_depth_deviation", "-", "relative deviation of the depth that a memory needs"},
               &memory_depth_deviation, 1e-3, 1);
  visitor.Boolean({"flush_lost_tracks", "-", "a lost track's leftover observations still update once"},
                  &flush_lost_tracks);
  visitor.Enumeration({"clone_policy", "-", "which clone leaves a full window"}, &clone_policy,
                      {{"oldest", ClonePolicy::kOldest},
                       {"keep_bases", ClonePolicy::kKeepBases},
                       {"alternate", ClonePolicy::kAlternate}});
  visitor.Integer(
      {"refine_iterations", "-", "Gauss-Newton steps on the landmark; landmark msckf and slam_features only"},
      &refine_iterations, 0, 50);
  visitor.Boolean(
      {"first_estimates", "-",
       "Jacobians at the first estimate of each pose and landmark: with so3xrn yaw stays unobservable"},
      &first_estimates);
  visitor.Integer({"slam_features", "-",
                   "at most this many long tracks become landmarks of the state, so that their information "
                   "outlives the window; 0 keeps none"},
                  &slam_features, 0, 100);
  visitor.Integer(
      {"slam_min_track", "-", "observations of a track before it may become a landmark of the state"},
      &slam_min_track, 3, 1000);
  visitor.Real({"slam_max_depth_deviation", "-",
                "relative deviation of its depth below which a track may become a landmark of the state"},
               &slam_max_depth_deviation, 1e-4, 1);
}

void SmootherConfig::Describe(ConfigVisitor& visitor) {
  visitor.Enumeration({"error", "-", "error convention of the manifolds"}, &error,
                      {{"right_invariant", ErrorConvention::kRightInvariant},
                       {"left_invariant", ErrorConvention::kLeftInvariant},
                       {"so3xrn", ErrorConvention::kSo3xRn}});
  visitor.Enumeration(
      {"landmark", "-", "inverse depth in the first frame, or depth solved inside the residual"}, &landmark,
      {{"pose_only", SmootherLandmark::kPoseOnly}, {"inverse_depth", SmootherLandmark::kInverseDepth}});
  visitor.Integer({"window", "-", "frames besides the newest"}, &window, 3, 100);
  visitor.Integer({"max_iterations", "-", "bounds the time and keeps it reproducible"}, &max_iterations, 1,
                  100);
  visitor.Enumeration({"frames", "-", "which frames stay in the window"}, &frames,
                      {{"keyframes", FramePolicy::kKeyframes}, {"every_frame", FramePolicy::kEveryFrame}});
  visitor.Real({"keyframe_parallax_px", "px", "mean parallax to the last keyframe that makes a new one"},
               &keyframe_parallax_px, 0, 500);
  visitor.Integer({"keyframe_min_tracked", "-", "fewer tracks from the last keyframe make a new one"},
                  &keyframe_min_tracked, 0, 1000);
  visitor.Integer({"max_landmarks", "-", "longest tracks first"}, &max_landmarks, 10, 5000);
  visitor.Integer(
      {"slam_features", "-",
       "at most this many tracks keep their landmark in the prior, so that its information outlives "
       "the window; 0 keeps none"},
      &slam_features, 0, 500);
  visitor.Boolean(
      {"first_estimates", "-",
       "Jacobians of a frame that the prior holds stay where the prior was linearised: with so3xrn yaw stays "
       "unobservable"},
      &first_estimates);
}

void CalibrationConfig::Describe(ConfigVisitor& visitor) {
  visitor.Boolean({"extrinsics", "-", "estimate the camera's pose on the body; needs turns about two axes"},
                  &extrinsics);
  visitor.Boolean({"time_offset", "-", "estimate the camera's time offset; needs motion that is not uniform"},
                  &time_offset);
  visitor.Boolean({"intrinsics", "-", "estimate focal lengths, principal point and lens coefficients"},
                  &intrinsics);
  visitor.Real({"rotation_std_rad", "rad", "of the given rotation T_BC, each axis; 2 degrees"},
               &rotation_std_rad, 1e-6, 0.5);
  visitor.Real({"translation_std_m", "m", "of the given position in T_BC, each axis"}, &translation_std_m,
               1e-6, 1);
  visitor.Real({"time_offset_std_s", "s", "of the given time offset"}, &time_offset_std_s, 1e-7, 0.1);
  visitor.Real({"focal_std_px", "px", "of each focal length"}, &focal_std_px, 1e-4, 1000);
  visitor.Real({"center_std_px", "px", "of each coordinate of the principal point"}, &center_std_px, 1e-4,
               1000);
  visitor.Real({"distortion_std", "-", "of each lens coefficient; 0 takes them as given"}, &distortion_std, 0,
               1);
}

void RecoveryConfig::Describe(ConfigVisitor& visitor) {
  visitor.Boolean(
      {"enabled", "-", "a lost estimate starts again from the data that follow; else the run ends"},
      &enabled);
  visitor.Real({"max_speed_mps", "m/s", "a faster estimate is lost"}, &max_speed_mps, 1, 1e4);
  visitor.Real({"max_gyro_bias_radps", "rad/s", "a larger estimated bias is no bias"}, &max_gyro_bias_radps,
               1e-3, 10);
  visitor.Real({"max_accel_bias_mps2", "m/s^2", "a larger estimated bias is no bias"}, &max_accel_bias_mps2,
               1e-3, 100);
  visitor.Real(
      {"max_suspect_s", "s",
       "an estimate that its tracks contradict for so long, without one frame that supports it, is lost"},
      &max_suspect_s, 0.1, 1e4);
}

void BatchConfig::Describe(ConfigVisitor& visitor) {
  visitor.Enumeration({"initial", "-", "whose run gives the initial values; set in its own section"},
                      &initial, {{"filter", BatchInitial::kFilter}, {"smoother", BatchInitial::kSmoother}});
  visitor.Integer({"max_iterations", "-", "of one solve; a sequence takes a few solves"}, &max_iterations, 1,
                  1000);
  visitor.Real({"tolerance_sigma", "sigma",
                "no state may be farther from the minimum, in its own standard deviations"},
               &tolerance_sigma, 1e-8, 1);
  visitor.Enumeration(
      {"robust_kernel", "-", "of the final estimate; any but none makes it less than efficient"},
      &robust_kernel,
      {{"none", RobustKernel::kNone}, {"huber", RobustKernel::kHuber}, {"cauchy", RobustKernel::kCauchy}});
  visitor.Real({"gate_probability", "-",
                "chi-square gate on whole tracks at the solution; a wide one, not to cut off honest noise"},
               &gate_probability, 0.5, 1.0);
  visitor.Boolean(
      {"filtering_bound", "-",
       "also the covariance of each state given the data up to it: what online estimators can reach"},
      &filtering_bound);
}

void EstimatorConfig::Describe(ConfigVisitor& visitor) {
  visitor.Text({"name", "-", "name in tables and paths"}, &name);
  visitor.Enumeration(
      {"backend", "-", "which back end runs"}, &backend,
      {{"filter", Backend::kFilter}, {"smoother", Backend::kSmoother}, {"batch", Backend::kBatch}});
  visitor.Section("vision", "noise, gates and kernels, shared by both back ends",
                  [&] { vision.Describe(visitor); });
  visitor.Section("imu", "gravity and trust in the sensor sheet", [&] { imu.Describe(visitor); });
  visitor.Section("init", "the start, shared by both back ends", [&] { init.Describe(visitor); });
  visitor.Section("frontend", "images to tracks", [&] { frontend.Describe(visitor); });
  visitor.Section("filter", "the sliding-window invariant EKF", [&] { filter.Describe(visitor); });
  visitor.Section("smoother", "the Ceres sliding window", [&] { smoother.Describe(visitor); });
  visitor.Section("batch", "the estimate from the whole sequence at once; a bound",
                  [&] { batch.Describe(visitor); });
  visitor.Section("calibration", "camera parameters estimated online, by both back ends",
                  [&] { calibration.Describe(visitor); });
  visitor.Section("recovery", "divergence and the start after it, shared by both back ends",
                  [&] { recovery.Describe(visitor); });
  visitor.Section("gnss", "raw GNSS", [&] { gnss.Describe(visitor); });
  visitor.Section("fix", "position fixes", [&] { fix.Describe(visitor); });
}

Status EstimatorConfig::Validate() const {
  if (filter.min_observations > filter.window + 1) {
    return Status::Config("filter.min_observations: " + std::to_string(filter.min_observations) +
                          " views never fit a window of " + std::to_string(filter.window) +
                          " clones and the newest frame");
  }
  if (filter.first_estimates && filter.track_memory != TrackMemoryPolicy::kNone) {
    return Status::Config(
        "filter.first_estimates: true, but memories of tracks are linearised at the current estimates; "
        "expected "
        "false, or filter.track_memory: none");
  }
  if (vision.min_depth_m >= vision.max_depth_m) {
    return Status::Config("vision.min_depth_m: must be less than vision.max_depth_m");
  }
  if (frontend.template_px != 0 && frontend.template_px < 5) {
    return Status::Config("frontend.template_px: " + std::to_string(frontend.template_px) +
                          " px do not tell how they are deformed; expected 0, or at least 5");
  }
  if (gnss.enabled && backend == Backend::kBatch) {
    return Status::Config(
        "gnss.enabled: true, but the batch back end takes no GNSS; expected false, or backend: "
        "filter or smoother");
  }
  if (calibration.any() && backend == Backend::kBatch) {
    return Status::Config(
        "calibration: the batch back end takes the camera as given; expected extrinsics, time_offset and "
        "intrinsics false, or backend: filter or smoother");
  }
  if (const Status systems = gnss.corrections.Validate(); !systems.ok()) {
    return Status::Config("gnss." + systems.message());
  }
  return Status::Ok();
}

}  // namespace alidade
