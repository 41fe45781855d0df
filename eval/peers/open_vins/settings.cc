#include "eval/peers/open_vins/settings.h"

#include <filesystem>
#include <memory>

namespace alidade::open_vins {
namespace {

using ov_msckf::VioManagerOptions;

Result<std::shared_ptr<ov_core::CamBase>> MakeCamera(const CameraModel& camera) {
  std::shared_ptr<ov_core::CamBase> made;
  if (camera.model() == DistortionModel::kEquidistant) {
    made = std::make_shared<ov_core::CamEqui>(camera.width_px(), camera.height_px());
  } else if (camera.model() == DistortionModel::kRadialTangential ||
             camera.model() == DistortionModel::kNone) {
    made = std::make_shared<ov_core::CamRadtan>(camera.width_px(), camera.height_px());
  } else {
    return Status::Input("OpenVINS has no lens model " + std::string(ToString(camera.model())));
  }
  Eigen::MatrixXd values(8, 1);
  values << camera.intrinsics(), camera.coefficients().head<4>();
  made->set_value(values);
  return made;
}

/// Quaternion and position of the body in the camera frame, as OpenVINS keeps its extrinsics.
Eigen::VectorXd ExtrinsicsOf(const Pose& T_BC) {
  const Pose T_CB = T_BC.Inverse();
  Eigen::VectorXd values(7);
  values << ov_core::rot_2_quat(T_CB.rotation), T_CB.translation;
  return values;
}

/// The same in the settings of the filter and of its initialisation.
template <typename Options>
Status SetCalibration(const RigCalibration& rig, Options* options) {
  const Result<std::shared_ptr<ov_core::CamBase>> camera = MakeCamera(rig.camera);
  ALIDADE_RETURN_IF_ERROR(camera.status());
  options->camera_intrinsics = {{0, *camera}};
  options->camera_extrinsics = {{0, ExtrinsicsOf(rig.T_BC)}};
  options->calib_camimu_dt = rig.camera_time_offset_s;
  options->use_stereo = false;
  return Status::Ok();
}

Status SetNoise(const PeerFlags& flags, const ImuNoise& sheet, VioManagerOptions* options) {
  double scale = 0;
  ALIDADE_RETURN_IF_ERROR(flags.Real("noise_scale", 0.1, 1000, &scale));
  if (scale > 0) {
    auto& noise = options->imu_noises;
    noise.sigma_w = scale * sheet.gyro_noise_density_radps_sqrthz;
    noise.sigma_a = scale * sheet.accel_noise_density_mps2_sqrthz;
    noise.sigma_wb = sheet.gyro_random_walk_radps2_sqrthz;
    noise.sigma_ab = sheet.accel_random_walk_mps3_sqrthz;
  }
  options->init_options.sigma_w = options->imu_noises.sigma_w;
  options->init_options.sigma_a = options->imu_noises.sigma_a;
  options->init_options.sigma_wb = options->imu_noises.sigma_wb;
  options->init_options.sigma_ab = options->imu_noises.sigma_ab;
  for (ov_msckf::UpdaterOptions* updater : {&options->msckf_options, &options->slam_options}) {
    ALIDADE_RETURN_IF_ERROR(flags.Real("pixel_noise_px", 0.01, 100, &updater->sigma_pix));
    updater->sigma_pix_sq = updater->sigma_pix * updater->sigma_pix;
    ALIDADE_RETURN_IF_ERROR(flags.Real("gate", 0.01, 1e6, &updater->chi2_multipler));
  }
  options->init_options.sigma_pix = options->msckf_options.sigma_pix;
  ALIDADE_RETURN_IF_ERROR(flags.Real("gravity", 9, 10, &options->gravity_mag));
  options->init_options.gravity_mag = options->gravity_mag;
  return Status::Ok();
}

Status SetSizes(const PeerFlags& flags, VioManagerOptions* options) {
  ov_msckf::StateOptions& state = options->state_options;
  constexpr int kMany = 10000;
  ALIDADE_RETURN_IF_ERROR(flags.Whole("clones", 2, 200, &state.max_clone_size));
  ALIDADE_RETURN_IF_ERROR(flags.Whole("slam", 0, kMany, &state.max_slam_features));
  ALIDADE_RETURN_IF_ERROR(flags.Whole("msckf_in_update", 1, kMany, &state.max_msckf_in_update));
  ALIDADE_RETURN_IF_ERROR(flags.Whole("features", 1, kMany, &options->num_pts));
  if (flags.Text("calibrate") == "no") {
    state.do_calib_camera_pose = state.do_calib_camera_intrinsics = state.do_calib_camera_timeoffset = false;
    state.do_calib_imu_intrinsics = state.do_calib_imu_g_sensitivity = false;
  } else if (flags.Text("calibrate") != "own") {
    return Status::Usage("--calibrate: found '" + flags.Text("calibrate") + "', expected own or no");
  }
  if (flags.Text("dynamic_init") != "own") {
    ALIDADE_RETURN_IF_ERROR(flags.OneOf("dynamic_init", "yes", "no", &options->init_options.init_dyn_use));
  }
  return Status::Ok();
}

/// Wall time and the number of cores may not change a result.
void MakeRepeatable(VioManagerOptions* options) {
  constexpr double kNoLimitS = 1e6;
  options->num_opencv_threads = 0;
  options->use_multi_threading_pubs = options->use_multi_threading_subs = false;
  options->init_options.init_dyn_mle_max_threads = 1;
  options->init_options.init_dyn_mle_max_time = kNoLimitS;
}

}  // namespace

Result<VioManagerOptions> MakeSettings(const PeerFlags& flags, const RigCalibration& rig) {
  const std::string path =
      std::string(ALIDADE_OPEN_VINS) + "/config/" + flags.Text("config") + "/estimator_config.yaml";
  if (!std::filesystem::is_regular_file(path)) {
    return Status::Input(path + ": no such file; --config names a folder of OpenVINS' config/");
  }
  VioManagerOptions options;
  options.print_and_load(std::make_shared<ov_core::YamlParser>(path));
  options.state_options.num_cameras = options.init_options.num_cameras = 1;
  options.state_options.max_aruco_features = 0;  // it takes low track ids for those of tags
  options.use_aruco = options.use_mask = false;
  ALIDADE_RETURN_IF_ERROR(SetCalibration(rig, &options));
  ALIDADE_RETURN_IF_ERROR(SetCalibration(rig, &options.init_options));
  ALIDADE_RETURN_IF_ERROR(SetNoise(flags, rig.imu_noise, &options));
  ALIDADE_RETURN_IF_ERROR(SetSizes(flags, &options));
  MakeRepeatable(&options);
  return options;
}

}  // namespace alidade::open_vins
