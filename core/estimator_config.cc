#include "core/estimator_config.h"

namespace alidade {

void VisionConfig::Describe(ConfigVisitor& visitor) {
  visitor.Real({"pixel_noise_px", "px", "standard deviation of one image coordinate of a track"},
               &pixel_noise_px, 0.01, 100);
  visitor.Real({"gate_probability", "-",
                "chi-square gate: a track is used if its NIS is below this quantile; 1 disables the gate"},
               &gate_probability, 0.5, 1.0);
  visitor.Real({"max_gated_share", "-",
                "consensus gate: when the gate rejects a larger share of the tracks, the state is suspect "
                "and all are used, with weights reduced to the gate"},
               &max_gated_share, 0, 1);
  visitor.Real({"max_relative_depth_deviation", "-",
                "parallax gate: largest relative standard deviation of the depth at which a track is used; "
                "above 0.05 the linearisation is poor"},
               &max_relative_depth_deviation, 1e-4, 10);
  visitor.Real({"min_depth_m", "m", "landmarks closer than this are rejected as mismatches"}, &min_depth_m,
               1e-3, 100);
  visitor.Real(
      {"max_depth_m", "m", "landmarks farther than this are rejected; they do not constrain translation"},
      &max_depth_m, 1, 1e5);
  visitor.Enumeration(
      {"robust_kernel", "-", "robust kernel for measurements that pass the gate"}, &robust_kernel,
      {{"none", RobustKernel::kNone}, {"huber", RobustKernel::kHuber}, {"cauchy", RobustKernel::kCauchy}});
  visitor.Real({"robust_scale_sigma", "sigma",
                "norm of the whitened residual above which the kernel reduces the weight"},
               &robust_scale_sigma, 0.1, 1e3);
  visitor.Boolean(
      {"rest_updates", "-",
       "use zero velocity as a measurement at rest, where tracks without parallax do not constrain velocity"},
      &rest_updates);
  visitor.Real({"rest_window_s", "s", "duration of rest before it is detected"}, &rest_window_s, 0.1, 10);
  visitor.Real({"rest_max_flow_px", "px", "largest image flow over the window at rest"}, &rest_max_flow_px,
               0.01, 20);
  visitor.Real({"rest_max_accel_std_mps2", "m/s^2",
                "largest standard deviation of specific force at rest; running rotors vibrate"},
               &rest_max_accel_std_mps2, 1e-3, 20);
  visitor.Real({"rest_velocity_std_mps", "m/s", "standard deviation of the zero velocity at rest"},
               &rest_velocity_std_mps, 1e-5, 1);
  visitor.Real({"rest_rate_std_radps", "rad/s", "standard deviation of the zero angular rate at rest"},
               &rest_rate_std_radps, 1e-6, 1);
}

void ImuConfig::Describe(ConfigVisitor& visitor) {
  visitor.Real({"gravity_mps2", "m/s^2", "magnitude of gravity; W has z up"}, &gravity_mps2, 9.7, 9.9);
  visitor.Real({"noise_scale", "-",
                "factor on the white-noise densities of the sensor sheet, which assume a stationary IMU; "
                "larger on vehicles"},
               &noise_scale, 0.1, 1000);
  visitor.Real({"random_walk_scale", "-", "factor on the bias random walks of the sensor sheet"},
               &random_walk_scale, 0.01, 1000);
  visitor.Real({"max_gap_s", "s", "a longer interval without IMU samples is reported as a gap"}, &max_gap_s,
               0.01, 10);
}

ImuNoise ImuConfig::Scaled(const ImuNoise& sheet) const {
  return {sheet.gyro_noise_density_radps_sqrthz * noise_scale,
          sheet.accel_noise_density_mps2_sqrthz * noise_scale,
          sheet.gyro_random_walk_radps2_sqrthz * random_walk_scale,
          sheet.accel_random_walk_mps3_sqrthz * random_walk_scale};
}

void InitConfig::Describe(ConfigVisitor& visitor) {
  visitor.Enumeration(
      {"method", "-",
       "truth needs ground truth with velocity and biases; auto uses static at rest, else dynamic"},
      &method,
      {{"truth", InitMethod::kTruth},
       {"static", InitMethod::kStatic},
       {"dynamic", InitMethod::kDynamic},
       {"auto", InitMethod::kAuto}});
  visitor.Real({"tilt_std_rad", "rad", "standard deviation of the prior of roll and pitch"}, &tilt_std_rad,
               1e-6, 1);
  visitor.Real({"yaw_std_rad", "rad",
                "standard deviation of the prior of yaw; yaw is unobservable, so it remains in every later "
                "covariance"},
               &yaw_std_rad, 1e-6, 4);
  visitor.Real({"position_std_m", "m", "standard deviation of the prior of position; unobservable like yaw"},
               &position_std_m, 1e-6, 100);
  visitor.Real({"velocity_std_mps", "m/s", "standard deviation of the prior of velocity"}, &velocity_std_mps,
               1e-6, 100);
  visitor.Real({"gyro_bias_std_radps", "rad/s", "standard deviation of the prior of the gyroscope bias"},
               &gyro_bias_std_radps, 1e-7, 1);
  visitor.Real({"accel_bias_std_mps2", "m/s^2", "standard deviation of the prior of the accelerometer bias"},
               &accel_bias_std_mps2, 1e-6, 5);
  visitor.Boolean({"perturb_truth", "-",
                   "method truth: draw the start from the prior; otherwise the first NEES would be zero"},
                  &perturb_truth);
  visitor.Real(
      {"static_window_s", "s", "duration of rest from which gravity and gyroscope bias are estimated"},
      &static_window_s, 0.1, 60);
  visitor.Real({"static_max_gyro_std_radps", "rad/s", "larger values are classified as motion"},
               &static_max_gyro_std_radps, 1e-5, 1);
  visitor.Real({"static_max_accel_std_mps2", "m/s^2", "larger values are classified as motion"},
               &static_max_accel_std_mps2, 1e-4, 10);
  visitor.Real(
      {"static_max_parallax_px", "px",
       "mean track motion over the window; larger values are classified as motion at constant velocity"},
      &static_max_parallax_px, 0.01, 100);
  visitor.Real({"dynamic_window_s", "s", "window of data of the dynamic initialisation"}, &dynamic_window_s,
               0.5, 20);
  visitor.Integer({"dynamic_min_frames", "-",
                   "smallest number of frames; fewer do not determine velocity, gravity and scale"},
                  &dynamic_min_frames, 4, 100);
  visitor.Real({"dynamic_min_parallax_px", "px",
                "smallest mean track motion over the window; with less the scale is unobservable"},
               &dynamic_min_parallax_px, 1, 500);
  visitor.Real(
      {"max_wait_s", "s", "without an initial state after this time the run ends and reports the reason"},
      &max_wait_s, 1, 1e5);
}

void FrontendConfig::Describe(ConfigVisitor& visitor) {
  visitor.Integer({"max_features", "-", "largest number of tracks in an image"}, &max_features, 10, 2000);
  visitor.Real({"min_distance_px", "px", "smallest distance between two tracks"}, &min_distance_px, 1, 200);
  visitor.Integer(
      {"grid_columns", "-", "corners are detected per grid cell, so they are distributed over the image"},
      &grid_columns, 1, 64);
  visitor.Integer({"grid_rows", "-", "see grid_columns"}, &grid_rows, 1, 64);
  visitor.Real({"corner_threshold", "grey", "FAST threshold: smallest contrast of a corner"},
               &corner_threshold, 1, 200);
  visitor.Integer({"pyramid_levels", "-", "pyramid levels above the full image"}, &pyramid_levels, 0, 6);
  visitor.Integer({"window_px", "px",
                   "side of the KLT window; a larger one is more affected by deformation of the image"},
                  &window_px, 5, 61);
  visitor.Integer(
      {"template_px", "px",
       "side of the patch kept from a track's first image; every image is matched to it under an affine "
       "deformation, which prevents drift of the track; 0 tracks from frame to frame only"},
      &template_px, 0, 41);
  visitor.Real(
      {"min_correlation", "-", "smallest correlation of the image with that patch; below it the track ends"},
      &min_correlation, 0, 1);
  visitor.Real({"ransac_threshold_px", "px", "largest distance to the epipolar line"}, &ransac_threshold_px,
               0.1, 20);
  visitor.Real({"forward_backward_px", "px",
                "largest distance between a point and its backward track, from frame to frame; 0 skips the "
                "backward pass"},
               &forward_backward_px, 0, 10);
  visitor.Boolean({"equalize", "-", "CLAHE before tracking; compensates exposure changes"}, &equalize);
  visitor.Boolean({"imu_prediction", "-", "start the search of each track at the gyroscope's prediction"},
                  &imu_prediction);
}

void FilterConfig::Describe(ConfigVisitor& visitor) {
  visitor.Enumeration({"error", "-", "error convention of the state"}, &error,
                      {{"right_invariant", ErrorConvention::kRightInvariant},
                       {"left_invariant", ErrorConvention::kLeftInvariant},
                       {"so3xrn", ErrorConvention::kSo3xRn}});
  visitor.Enumeration({"landmark", "-", "how the depth at the linearisation point of a track is computed"},
                      &landmark,
                      {{"pose_only_multi", FilterLandmark::kPoseOnlyMulti},
                       {"pose_only_two", FilterLandmark::kPoseOnlyTwo},
                       {"msckf", FilterLandmark::kMsckf}});
  visitor.Enumeration({"update", "-", "when a track updates the state"}, &update,
                      {{"immediate", UpdateTiming::kImmediate},
                       {"delayed_all", UpdateTiming::kDelayedAll},
                       {"at_l", UpdateTiming::kAtL}});
  visitor.Integer(
      {"min_observations", "-", "smallest number of views of a track for an update; L of the paper"},
      &min_observations, 2, 100);
  visitor.Integer({"window", "-", "number of clones in the window"}, &window, 3, 200);
  visitor.Enumeration({"base_reuse", "-", "what happens to the base observation after an immediate update"},
                      &base_reuse,
                      {{"paper", BaseReuse::kPaper},
                       {"inflate", BaseReuse::kInflate},
                       {"limit", BaseReuse::kLimit},
                       {"disjoint", BaseReuse::kDisjoint}});
  visitor.Real({"base_inflation", "-", "factor on the standard deviation of a re-used base observation"},
               &base_inflation, 1, 100);
  visitor.Integer(
      {"max_base_rounds", "-", "largest number of updates that use one base, with base_reuse: limit"},
      &max_base_rounds, 1, 1000);
  visitor.Enumeration(
      {"track_memory", "-", "which landmark information is kept after an update; replaces base_reuse"},
      &track_memory,
      {{"none", TrackMemoryPolicy::kNone},
       {"window", TrackMemoryPolicy::kWindow},
       {"carry", TrackMemoryPolicy::kCarry}});
  visitor.Real({"memory_depth_deviation", "-",
                "largest relative standard deviation of the depth at which a memory starts"},
               &memory_depth_deviation, 1e-3, 1);
  visitor.Boolean(
      {"flush_lost_tracks", "-", "use the remaining observations of a lost track in one last update"},
      &flush_lost_tracks);
  visitor.Enumeration({"clone_policy", "-", "which clone is removed from a full window"}, &clone_policy,
                      {{"oldest", ClonePolicy::kOldest},
                       {"keep_bases", ClonePolicy::kKeepBases},
                       {"alternate", ClonePolicy::kAlternate}});
  visitor.Integer(
      {"refine_iterations", "-",
       "largest number of Gauss-Newton steps on the landmark; landmark msckf and slam_features only"},
      &refine_iterations, 0, 50);
  visitor.Boolean({"first_estimates", "-",
                   "evaluate Jacobians at the first estimate of each pose and landmark: with so3xrn yaw then "
                   "stays unobservable"},
                  &first_estimates);
  visitor.Integer({"slam_features", "-",
                   "largest number of SLAM features: long tracks as landmarks of the state, whose "
                   "information outlives the window; 0: none"},
                  &slam_features, 0, 100);
  visitor.Integer(
      {"slam_min_track", "-", "smallest number of observations of a track that becomes a SLAM feature"},
      &slam_min_track, 3, 1000);
  visitor.Real({"slam_max_depth_deviation", "-",
                "largest relative standard deviation of the depth of a track that becomes a SLAM feature"},
               &slam_max_depth_deviation, 1e-4, 1);
}

void SmootherConfig::Describe(ConfigVisitor& visitor) {
  visitor.Enumeration({"error", "-", "error convention of the manifolds"}, &error,
                      {{"right_invariant", ErrorConvention::kRightInvariant},
                       {"left_invariant", ErrorConvention::kLeftInvariant},
                       {"so3xrn", ErrorConvention::kSo3xRn}});
  visitor.Enumeration(
      {"landmark", "-", "inverse_depth: explicit in the first frame; pose_only: solved inside the residual"},
      &landmark,
      {{"pose_only", SmootherLandmark::kPoseOnly}, {"inverse_depth", SmootherLandmark::kInverseDepth}});
  visitor.Integer({"window", "-", "number of frames besides the newest"}, &window, 3, 100);
  visitor.Integer(
      {"max_iterations", "-", "largest number of solver iterations; bounds the time reproducibly"},
      &max_iterations, 1, 100);
  visitor.Enumeration({"frames", "-", "which frames stay in the window"}, &frames,
                      {{"keyframes", FramePolicy::kKeyframes}, {"every_frame", FramePolicy::kEveryFrame}});
  visitor.Real({"keyframe_parallax_px", "px",
                "mean parallax to the last keyframe at which a frame becomes a keyframe"},
               &keyframe_parallax_px, 0, 500);
  visitor.Integer({"keyframe_min_tracked", "-",
                   "a frame that shares fewer tracks with the last keyframe becomes a keyframe"},
                  &keyframe_min_tracked, 0, 1000);
  visitor.Integer({"max_landmarks", "-", "largest number of landmarks in the window, longest tracks first"},
                  &max_landmarks, 10, 5000);
  visitor.Integer({"slam_features", "-",
                   "largest number of SLAM features: landmarks in the prior, whose information outlives the "
                   "window; 0: none"},
                  &slam_features, 0, 500);
  visitor.Boolean({"first_estimates", "-",
                   "evaluate Jacobians of frames in the prior where the prior was linearised: with so3xrn "
                   "yaw then stays unobservable"},
                  &first_estimates);
}

void CalibrationConfig::Describe(ConfigVisitor& visitor) {
  visitor.Boolean(
      {"extrinsics", "-", "estimate the camera's pose on the body; needs rotation about two axes"},
      &extrinsics);
  visitor.Boolean({"time_offset", "-", "estimate the camera's time offset; needs motion that is not uniform"},
                  &time_offset);
  visitor.Boolean({"intrinsics", "-", "estimate focal lengths, principal point and lens coefficients"},
                  &intrinsics);
  visitor.Real({"rotation_std_rad", "rad",
                "prior standard deviation of the given rotation of T_BC, each axis; 2 degrees"},
               &rotation_std_rad, 1e-6, 0.5);
  visitor.Real(
      {"translation_std_m", "m", "prior standard deviation of the given position of T_BC, each axis"},
      &translation_std_m, 1e-6, 1);
  visitor.Real({"time_offset_std_s", "s", "prior standard deviation of the given time offset"},
               &time_offset_std_s, 1e-7, 0.1);
  visitor.Real({"focal_std_px", "px", "prior standard deviation of each focal length"}, &focal_std_px, 1e-4,
               1000);
  visitor.Real({"center_std_px", "px", "prior standard deviation of each coordinate of the principal point"},
               &center_std_px, 1e-4, 1000);
  visitor.Real(
      {"distortion_std", "-", "prior standard deviation of each lens coefficient; 0 keeps them fixed"},
      &distortion_std, 0, 1);
}

void RecoveryConfig::Describe(ConfigVisitor& visitor) {
  visitor.Boolean(
      {"enabled", "-", "re-initialise a lost estimate from the data that follow; otherwise the run ends"},
      &enabled);
  visitor.Real({"max_speed_mps", "m/s", "an estimate with a higher speed is lost"}, &max_speed_mps, 1, 1e4);
  visitor.Real({"max_gyro_bias_radps", "rad/s", "an estimate with a larger bias is lost"},
               &max_gyro_bias_radps, 1e-3, 10);
  visitor.Real({"max_accel_bias_mps2", "m/s^2", "an estimate with a larger bias is lost"},
               &max_accel_bias_mps2, 1e-3, 100);
  visitor.Real({"max_suspect_s", "s",
                "an estimate that is contradicted by its tracks for this time, without a frame that supports "
                "it, is lost"},
               &max_suspect_s, 0.1, 1e4);
}

void BatchConfig::Describe(ConfigVisitor& visitor) {
  visitor.Enumeration(
      {"initial", "-", "estimator that gives the initial values; configured in its own section"}, &initial,
      {{"filter", BatchInitial::kFilter}, {"smoother", BatchInitial::kSmoother}});
  visitor.Integer(
      {"max_iterations", "-", "largest number of iterations of one solve; a sequence takes a few solves"},
      &max_iterations, 1, 1000);
  visitor.Real({"tolerance_sigma", "sigma",
                "convergence: largest distance of a state from the minimum, in its own standard deviations"},
               &tolerance_sigma, 1e-8, 1);
  visitor.Enumeration(
      {"robust_kernel", "-", "kernel of the final estimate; any kernel but none loses efficiency"},
      &robust_kernel,
      {{"none", RobustKernel::kNone}, {"huber", RobustKernel::kHuber}, {"cauchy", RobustKernel::kCauchy}});
  visitor.Real(
      {"gate_probability", "-",
       "chi-square gate on whole tracks at the solution; wide, so that it does not reject nominal noise"},
      &gate_probability, 0.5, 1.0);
  visitor.Boolean(
      {"filtering_bound", "-",
       "also compute the covariance of each state given the data up to it: the bound of online estimators"},
      &filtering_bound);
}

void EstimatorConfig::Describe(ConfigVisitor& visitor) {
  visitor.Text({"name", "-", "name of the estimator in tables and paths"}, &name);
  visitor.Enumeration(
      {"backend", "-", "which back end runs"}, &backend,
      {{"filter", Backend::kFilter}, {"smoother", Backend::kSmoother}, {"batch", Backend::kBatch}});
  visitor.Section("vision", "noise, gates and kernels, shared by both back ends",
                  [&] { vision.Describe(visitor); });
  visitor.Section("imu", "gravity and factors on the noise of the sensor sheet",
                  [&] { imu.Describe(visitor); });
  visitor.Section("init", "initialisation, shared by both back ends", [&] { init.Describe(visitor); });
  visitor.Section("frontend", "images to tracks", [&] { frontend.Describe(visitor); });
  visitor.Section("filter", "the sliding-window invariant EKF", [&] { filter.Describe(visitor); });
  visitor.Section("smoother", "the Ceres sliding window", [&] { smoother.Describe(visitor); });
  visitor.Section("batch", "estimate from the whole sequence at once; a bound",
                  [&] { batch.Describe(visitor); });
  visitor.Section("calibration", "camera parameters estimated online, by both back ends",
                  [&] { calibration.Describe(visitor); });
  visitor.Section("recovery", "detection of divergence and re-initialisation, shared by both back ends",
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
