#include "eval/simulation/simulator_config.h"

#include <filesystem>

#include "eval/config/config_yaml.h"

namespace alidade {
namespace {

void DescribeImu(SimulatorConfig* config, ConfigVisitor& visitor) {
  ImuNoise* noise = &config->imu_noise;
  visitor.Real({"imu_rate_hz", "Hz", "value of the paper's simulation"}, &config->imu_rate_hz, 1, 1e4);
  visitor.Real({"gyro_noise_density", "rad/s/sqrt(Hz)", "white noise; value of the paper's simulation"},
               &noise->gyro_noise_density_radps_sqrthz, 0, 1);
  visitor.Real({"accel_noise_density", "m/s^2/sqrt(Hz)", "white noise; value of the paper's simulation"},
               &noise->accel_noise_density_mps2_sqrthz, 0, 10);
  visitor.Real(
      {"gyro_random_walk", "rad/s^2/sqrt(Hz)", "random walk of the bias; value of the paper's simulation"},
      &noise->gyro_random_walk_radps2_sqrthz, 0, 1);
  visitor.Real(
      {"accel_random_walk", "m/s^3/sqrt(Hz)", "random walk of the bias; value of the paper's simulation"},
      &noise->accel_random_walk_mps3_sqrthz, 0, 10);
  visitor.Real({"gravity_mps2", "m/s^2", "magnitude; W has z up"}, &config->gravity_mps2, 0, 30);
  visitor.Real({"gyro_bias_radps", "rad/s", "standard deviation of the turn-on bias, each axis"},
               &config->gyro_bias_radps, 0, 1);
  visitor.Real({"accel_bias_mps2", "m/s^2", "standard deviation of the turn-on bias, each axis"},
               &config->accel_bias_mps2, 0, 10);
  visitor.Real({"gyro_scale_std", "-",
                "standard deviation of the scale error of each axis, constant in a run; not modelled by the "
                "estimators (MEMS: 0.001 to 0.01)"},
               &config->gyro_scale_std, 0, 0.2);
  visitor.Real({"accel_scale_std", "-", "the same for the accelerometer"}, &config->accel_scale_std, 0, 0.2);
  visitor.Real({"misalignment_std_rad", "rad",
                "standard deviation of the small angles between true and sensed axes, six a sensor, constant "
                "in a run"},
               &config->misalignment_std_rad, 0, 0.2);
}

void DescribeCamera(SimulatorConfig* config, ConfigVisitor& visitor) {
  visitor.Real({"camera_rate_hz", "Hz", "value of the paper's simulation"}, &config->camera_rate_hz, 0.1,
               1e3);
  visitor.Enumeration({"camera_view", "-",
                       "forward: along body x, little parallax ahead; sideways: along body y; dataset: the "
                       "calibrated camera of the folder in trajectory_file"},
                      &config->camera_view,
                      {{"forward", SimCameraView::kForward},
                       {"sideways", SimCameraView::kSideways},
                       {"dataset", SimCameraView::kDataset}});
  visitor.Vector3(
      {"camera_lever_arm_m", "m", "position of the camera in the body frame, x forward y left z up"},
      &config->camera_lever_arm_m, -10, 10);
  visitor.Real(
      {"camera_time_offset_s", "s", "t_imu = t_camera + offset; the written calibration contains it"},
      &config->camera_time_offset_s, -1, 1);
  visitor.Integer({"width_px", "px", "value of the paper's simulation"}, &config->width_px, 16, 20000);
  visitor.Integer({"height_px", "px", "value of the paper's simulation"}, &config->height_px, 16, 20000);
  visitor.Real({"focal_px", "px", "both axes; the principal point is the image centre"}, &config->focal_px, 1,
               1e5);
  visitor.Enumeration({"distortion", "-", "lens model of the written pixels"}, &config->distortion,
                      {{"none", DistortionModel::kNone},
                       {"radial-tangential", DistortionModel::kRadialTangential},
                       {"equidistant", DistortionModel::kEquidistant},
                       {"fov", DistortionModel::kFov},
                       {"double-sphere", DistortionModel::kDoubleSphere},
                       {"eucm", DistortionModel::kEucm}});
  constexpr const char* kNames[] = {"distortion_1", "distortion_2", "distortion_3", "distortion_4"};
  for (int i = 0; i < 4; ++i) {
    visitor.Real(
        {kNames[i], "-",
         "coefficient in the lens model's order (k1 k2 p1 p2 | k1 k2 k3 k4 | w | xi alpha | alpha beta); "
         "others must be 0"},
        &config->distortion_coefficients[i], -10, 10);
  }
}

void DescribeMoreCameras(SimulatorConfig* config, ConfigVisitor& visitor) {
  visitor.Integer({"camera_count", "-",
                   "2 is stereo; cam1 and further cameras are written and part of the digest, but estimators "
                   "read cam0 alone"},
                  &config->camera_count, 1, 8);
  visitor.Vector3({"camera_spacing_m", "m",
                   "from each camera to the next, in the frame of the first of the two: x right, y down, z "
                   "forward; EuRoC's baseline"},
                  &config->camera_spacing_m, -10, 10);
  visitor.Real(
      {"camera_turn_rad", "rad", "rotation of each camera to the right of the previous one; 0 is stereo"},
      &config->camera_turn_rad, -3.2, 3.2);
}

void DescribeTracks(SimulatorConfig* config, ConfigVisitor& visitor) {
  visitor.Real({"pixel_noise_px", "px", "standard deviation of each image coordinate of an observation"},
               &config->pixel_noise_px, 0, 100);
  visitor.Real(
      {"noise_ratio_spread", "-",
       "the noise of each observation is pixel_noise_px times a ratio of its own, whose logarithm has "
       "this standard deviation; the ratios are in the tracks"},
      &config->noise_ratio_spread, 0, 2);
  visitor.Integer({"max_features", "-", "largest number of tracks in a frame"}, &config->max_features, 1,
                  10000);
  visitor.Real({"mean_track_loss", "-",
                "probability that a visible track is lost from one frame to the next; p alone gives tracks "
                "of 1 / p frames on average (0.125: 8)"},
               &config->mean_track_loss, 0, 1);
  visitor.Real(
      {"border_px", "px",
       "landmarks closer to the edge of the image are not visible, so the noise is not truncated there"},
      &config->border_px, 0, 1e3);
  visitor.Real({"max_range_m", "m", "landmarks farther from the camera are not visible"},
               &config->max_range_m, 0.1, 1e5);
  visitor.Real({"outlier_rate", "-", "fraction of the observations or of the tracks that are wrong"},
               &config->outlier_rate, 0, 1);
  visitor.Enumeration({"outlier_kind", "-",
                       "jump: easy to gate; drift and moving: consistent for some time; swap: exchanges ids; "
                       "mixed: any of them"},
                      &config->outlier_kind,
                      {{"jump", SimOutlierKind::kJump},
                       {"uniform", SimOutlierKind::kUniform},
                       {"swap", SimOutlierKind::kSwap},
                       {"drift", SimOutlierKind::kDrift},
                       {"moving", SimOutlierKind::kMoving},
                       {"mixed", SimOutlierKind::kMixed}});
  visitor.Enumeration(
      {"outlier_unit", "-",
       "whether single observations or whole tracks are wrong; drift, moving and mixed always affect tracks"},
      &config->outlier_unit,
      {{"observation", SimOutlierUnit::kObservation}, {"track", SimOutlierUnit::kTrack}});
  visitor.Real(
      {"outlier_px", "px",
       "mean size of a jump, or mean drift in one second; drawn between half and one and a half of it"},
      &config->outlier_px, 0, 1e4);
  visitor.Real({"outlier_speed_mps", "m/s",
                "mean speed of a moving landmark; drawn between half and one and a half of it; 1 m/s is a "
                "walking person"},
               &config->outlier_speed_mps, 0, 100);
}

void DescribeMiscalibration(SimulatorConfig* config, ConfigVisitor& visitor) {
  visitor.Real({"calibration_rotation_error_rad", "rad",
                "rotation error of the given T_BC about a random axis; for online calibration"},
               &config->calibration_rotation_error_rad, 0, 1);
  visitor.Real(
      {"calibration_translation_error_m", "m", "translation error of the given T_BC in a random direction"},
      &config->calibration_translation_error_m, 0, 10);
  visitor.Real({"calibration_time_error_s", "s", "error of the given time offset, random sign"},
               &config->calibration_time_error_s, 0, 1);
  visitor.Real({"calibration_line_delay_error_s", "s",
                "error of the given line delay, random sign; 1e-5: 5 ms over 480 rows"},
               &config->calibration_line_delay_error_s, 0, 1e-3);
  visitor.Real({"calibration_focal_error_px", "px", "error of each given focal length, random sign"},
               &config->calibration_focal_error_px, 0, 1000);
  visitor.Real({"calibration_center_error_px", "px",
                "error of each coordinate of the given principal point, random sign"},
               &config->calibration_center_error_px, 0, 1000);
  visitor.Real({"calibration_antenna_error_m", "m",
                "error of the given lever arm of the GNSS antenna and of the position sensor, in a random "
                "direction"},
               &config->calibration_antenna_error_m, 0, 100);
}

void DescribeFaults(SimulatorConfig* config, ConfigVisitor& visitor) {
  visitor.Enumeration(
      {"fault", "-",
       "simulated failure of camera, IMU, track ids or GNSS, to test what is reported and what is recovered"},
      &config->fault,
      {{"none", SimFaultKind::kNone},
       {"blackout", SimFaultKind::kBlackout},
       {"imu", SimFaultKind::kImu},
       {"tracks", SimFaultKind::kTracks},
       {"blackout_and_imu", SimFaultKind::kBlackoutAndImu},
       {"frozen", SimFaultKind::kFrozen},
       {"imu_gap", SimFaultKind::kImuGap},
       {"gyro_spike", SimFaultKind::kGyroSpike},
       {"accel_spike", SimFaultKind::kAccelSpike},
       {"gyro_saturation", SimFaultKind::kGyroSaturation},
       {"accel_saturation", SimFaultKind::kAccelSaturation},
       {"gyro_stuck", SimFaultKind::kGyroStuck},
       {"accel_stuck", SimFaultKind::kAccelStuck},
       {"gyro_frozen", SimFaultKind::kGyroFrozen},
       {"imu_frozen", SimFaultKind::kImuFrozen},
       {"imu_unit", SimFaultKind::kImuUnit},
       {"imu_clock", SimFaultKind::kImuClock},
       {"frame_drops", SimFaultKind::kFrameDrops},
       {"camera_clock", SimFaultKind::kCameraClock},
       {"gnss_ramp", SimFaultKind::kGnssRamp},
       {"gnss_ramp_no_rates", SimFaultKind::kGnssRampNoRates},
       {"stale_ephemerides", SimFaultKind::kStaleEphemerides},
       {"glare", SimFaultKind::kGlare},
       {"blur", SimFaultKind::kBlur}});
  visitor.Real({"fault_start_s", "s", "start of the fault after the first IMU sample"},
               &config->fault_start_s, 0, 1e5);
  visitor.Real({"fault_duration_s", "s",
                "duration of the fault; without meaning for camera_clock, imu_clock, imu_unit and "
                "stale_ephemerides"},
               &config->fault_duration_s, 0, 1e5);
  visitor.Real({"fault_drop_rate", "-", "share of the frames that frame_drops takes away, one by one"},
               &config->fault_drop_rate, 0, 1);
  visitor.Real({"fault_clock_jump_s", "s",
                "camera_clock, imu_clock: added to the stamps from the start of the fault on; imu_clock: "
                "greater than 0"},
               &config->fault_clock_jump_s, -100, 100);
  visitor.Real(
      {"fault_limit_share", "-",
       "gyro_saturation, accel_saturation: an axis is clipped at its mean magnitude and this share of "
       "what its largest magnitude exceeds it by, both over the sequence"},
      &config->fault_limit_share, 0, 1);
  visitor.Real({"fault_ramp_mps", "m/s",
                "gnss_ramp and gnss_ramp_no_rates: speed of the pull, in a random horizontal direction; "
                "afterwards it stays"},
               &config->fault_ramp_mps, 0, 100);
  visitor.Real(
      {"fault_blur_px", "px", "blur: standard deviation of the Gaussian that blurs a rendered image"},
      &config->fault_blur_px, 0.1, 100);
  DescribeMiscalibration(config, visitor);
}

void DescribeLandmarks(SimulatorConfig* config, ConfigVisitor& visitor) {
  visitor.Enumeration({"landmark_layout", "-",
                       "shell: between two distances around the path; room: on floor, ceiling and walls of a "
                       "box around it; volume: uniform density in the space around it"},
                      &config->landmark_layout,
                      {{"shell", SimLandmarkLayout::kShell},
                       {"room", SimLandmarkLayout::kRoom},
                       {"volume", SimLandmarkLayout::kVolume}});
  visitor.Real({"landmark_min_distance_m", "m", "smallest distance of a landmark to the path"},
               &config->landmark_min_distance_m, 0.1, 1e4);
  visitor.Real(
      {"landmark_max_distance_m", "m",
       "largest distance of a landmark to the path; determines the length of tracks; shell and volume"},
      &config->landmark_max_distance_m, 0.1, 1e4);
  visitor.Integer({"landmark_count", "-",
                   "number of landmarks; with fewer landmarks tracks are fewer and longer: 800 give about "
                   "115 tracks a frame of 24 frames each, 1500 give 148 of 20; layouts shell and room"},
                  &config->landmark_count, 1, 1000000);
  visitor.Real({"landmark_density_per_m3", "1/m^3",
                "landmarks in a cubic metre of the space around the path; layout volume"},
               &config->landmark_density_per_m3, 1e-6, 1e3);
  visitor.Vector3({"room_margin_m", "m", "distance from the path's bounding box to the walls; layout room"},
                  &config->room_margin_m, 0.1, 1e4);
  visitor.Real({"room_depth_m", "m",
                "largest distance of a landmark from its wall; with 0 a view may show a single plane; room"},
               &config->room_depth_m, 0, 1e4);
}

/// Makes a path from a file in `folder` independent of the working folder.
void ResolvePath(const std::filesystem::path& folder, std::string* path) {
  if (*path != kNoPath && *path != kRequiredPath) {
    *path = (folder / *path).lexically_normal().string();
  }
}

}  // namespace

bool SimulatorConfig::OutliersAreTracks() const {
  return outlier_unit == SimOutlierUnit::kTrack || outlier_kind == SimOutlierKind::kDrift ||
         outlier_kind == SimOutlierKind::kMoving || outlier_kind == SimOutlierKind::kMixed;
}

void SimulatorConfig::Describe(ConfigVisitor& visitor) {
  visitor.Text({"name", "-", "name of the sequence in tables and paths"}, &name);
  visitor.Integer(
      {"start_time_s", "s", "stamp of the first sample; not 0, so that a missing offset is detected"},
      &start_time_s, 0, 2000000000);
  DescribeMotion(visitor);
  DescribeImu(this, visitor);
  DescribeCamera(this, visitor);
  DescribeMoreCameras(this, visitor);
  DescribeTracks(this, visitor);
  DescribeFaults(this, visitor);
  DescribeLandmarks(this, visitor);
  DescribeSensors(visitor);
  visitor.Section("render", "rendered images", [&] { render.Describe(visitor); });
}

Result<SimulatorConfig> LoadSimulatorConfig(const std::string& path,
                                            const std::vector<std::string>& settings) {
  SimulatorConfig config;
  const auto describe = [&config](ConfigVisitor& visitor) { config.Describe(visitor); };
  ALIDADE_RETURN_IF_ERROR(ReadConfigFile(path, describe));
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  ResolvePath(folder, &config.trajectory_file);
  ResolvePath(folder, &config.hybrid_dataset);
  ResolvePath(folder, &config.gnss.navigation_file);
  ALIDADE_RETURN_IF_ERROR(ApplySettings(settings, describe));
  if (const Status valid = config.Validate(); !valid.ok()) {
    return Status(valid.code(), path + ": " + valid.message());
  }
  return config;
}

}  // namespace alidade
