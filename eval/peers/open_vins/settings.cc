#include "eval/peers/open_vins/settings.h"

#include <filesystem>
#include <memory>

namespace alidade::open_vins {
namespace {

using vio::VioManagerOptions;
using Values = Eigen::Matrix<Real, Eigen::Dynamic, 1>;

Result<std::shared_ptr<ov_core::CamBase>> MakeCamera(const CameraModel& camera) {
  std::shared_ptr<ov_core::CamBase> made;
  if (camera.model() == DistortionModel::kEquidistant) {
    made = std::make_shared<ov_core::CamEqui>(camera.width_px(), camera.height_px());
  } else if (camera.model() == DistortionModel::kRadialTangential ||
             camera.model() == DistortionModel::kNone) {
    made = std::make_shared<ov_core::CamRadtan>(camera.width_px(), camera.height_px());
  } else {
    return Status::Input(std::string(kSystem) + " has no lens model " +
                         std::string(ToString(camera.model())));
  }
  Eigen::VectorXd values(8);
  values << camera.intrinsics(), camera.coefficients().head<4>();
  made->set_value(values.cast<Real>());
  return made;
}

/// Quaternion and position of the body in the camera frame, as the system keeps its extrinsics.
Values ExtrinsicsOf(const Pose& T_BC) {
  const Pose T_CB = T_BC.Inverse();
  Values values(7);
  values << ov_core::rot_2_quat(T_CB.rotation.cast<Real>()), T_CB.translation.cast<Real>();
  return values;
}

/// The same in the settings of the filter and of its initialisation.
template <typename Options>
Status SetCalibration(const RigCalibration& rig, Options* options) {
  const Result<std::shared_ptr<ov_core::CamBase>> camera = MakeCamera(rig.camera);
  ALIDADE_RETURN_IF_ERROR(camera.status());
  options->camera_intrinsics = {{0, *camera}};
  options->camera_extrinsics = {{0, ExtrinsicsOf(rig.T_BC)}};
  options->calib_camimu_dt = static_cast<Real>(rig.camera_time_offset_s);
  options->use_stereo = false;
  return Status::Ok();
}

/// As PeerFlags::Real, for a setting in the system's precision.
template <typename Setting>
Status SetReal(const PeerFlags& flags, const std::string& name, double min, double max, Setting* setting) {
  auto value = static_cast<double>(*setting);
  ALIDADE_RETURN_IF_ERROR(flags.Real(name, min, max, &value));
  *setting = static_cast<Setting>(value);
  return Status::Ok();
}

Status SetNoise(const PeerFlags& flags, const ImuNoise& sheet, VioManagerOptions* options) {
  double scale = 0;
  ALIDADE_RETURN_IF_ERROR(flags.Real("noise_scale", 0.1, 1000, &scale));
  if (scale > 0) {
    auto& noise = options->imu_noises;
    noise.sigma_w = static_cast<Real>(scale * sheet.gyro_noise_density_radps_sqrthz);
    noise.sigma_a = static_cast<Real>(scale * sheet.accel_noise_density_mps2_sqrthz);
    noise.sigma_wb = static_cast<Real>(sheet.gyro_random_walk_radps2_sqrthz);
    noise.sigma_ab = static_cast<Real>(sheet.accel_random_walk_mps3_sqrthz);
  }
  options->init_options.sigma_w = options->imu_noises.sigma_w;
  options->init_options.sigma_a = options->imu_noises.sigma_a;
  options->init_options.sigma_wb = options->imu_noises.sigma_wb;
  options->init_options.sigma_ab = options->imu_noises.sigma_ab;
  for (vio::UpdaterOptions* updater : {&options->msckf_options, &options->slam_options}) {
    ALIDADE_RETURN_IF_ERROR(SetReal(flags, "pixel_noise_px", 0.01, 100, &updater->sigma_pix));
    ALIDADE_RETURN_IF_ERROR(SetReal(flags, "gate", 0.01, 1e6, &updater->chi2_multipler));
    SetPowers(updater);
  }
  options->init_options.sigma_pix = options->msckf_options.sigma_pix;
  ALIDADE_RETURN_IF_ERROR(SetReal(flags, "gravity", 9, 10, &options->gravity_mag));
  options->init_options.gravity_mag = options->gravity_mag;
  return Status::Ok();
}

Status SetSizes(const PeerFlags& flags, VioManagerOptions* options) {
  vio::StateOptions& state = options->state_options;
  constexpr int kMany = 10000;
  ALIDADE_RETURN_IF_ERROR(flags.Whole("clones", 2, 200, &state.max_clone_size));
  ALIDADE_RETURN_IF_ERROR(flags.Whole("slam", 0, kMany, &state.max_slam_features));
  ALIDADE_RETURN_IF_ERROR(flags.Whole("msckf_in_update", 1, kMany, &state.max_msckf_in_update));
  ALIDADE_RETURN_IF_ERROR(flags.Whole("features", 1, kMany, &options->num_pts));
  if (flags.Text("calibrate") == "no") {
    state.do_calib_camera_pose = state.do_calib_camera_intrinsics = state.do_calib_camera_timeoffset = false;
#ifndef ALIDADE_SQRT_VINS
    state.do_calib_imu_intrinsics = state.do_calib_imu_g_sensitivity = false;
#endif
  } else if (flags.Text("calibrate") != "own") {
    return Status::Usage("--calibrate: found '" + flags.Text("calibrate") + "', expected own or no");
  }
  if (flags.Text("dynamic_init") != "own") {
    ALIDADE_RETURN_IF_ERROR(flags.OneOf("dynamic_init", "yes", "no", &options->init_options.init_dyn_use));
  }
  return Status::Ok();
}

/// Wall time and the number of cores may not change a result, and nothing is written beside the output.
void MakeRepeatable(VioManagerOptions* options) {
  options->num_opencv_threads = 0;
  options->use_multi_threading_pubs = options->use_multi_threading_subs = false;
#ifdef ALIDADE_SQRT_VINS
  options->init_options.record_init_pose = options->init_options.record_init_timing = false;
#else
  constexpr double kNoLimitS = 1e6;
  options->init_options.init_dyn_mle_max_threads = 1;
  options->init_options.init_dyn_mle_max_time = kNoLimitS;
#endif
}

}  // namespace

Result<VioManagerOptions> MakeSettings(const PeerFlags& flags, const RigCalibration& rig) {
  const std::string path =
      std::string(ALIDADE_PEER_CHECKOUT) + "/config/" + flags.Text("config") + "/estimator_config.yaml";
  if (!std::filesystem::is_regular_file(path)) {
    return Status::Input(path + ": no such file; --config names a folder of its config/");
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
