#include "eval/peers/ingvio_files.h"

#include <utility>
#include <vector>

#include "core/format.h"
#include "eval/peers/yaml_line.h"

namespace alidade {
namespace {

constexpr char kHead[] = "%YAML:1.0\n";  // as OpenCV's reader needs it

std::string Map(const char* key, const std::vector<std::pair<const char*, double>>& values) {
  std::string text = std::string(key) + ":\n";
  for (const auto& [name, value] : values) {
    text += Format("   %s: %.17g\n", name, value);
  }
  return text;
}

template <typename Matrix>
std::string MatrixText(const char* key, const Matrix& matrix) {
  std::string data;
  for (int i = 0; i < matrix.rows(); ++i) {
    for (int j = 0; j < matrix.cols(); ++j) {
      data += Format("%s%.17g", data.empty() ? "" : ", ", matrix(i, j));
    }
  }
  return Format("%s: !!opencv-matrix\n   rows: %d\n   cols: %d\n   dt: d\n   data: [", key,
                static_cast<int>(matrix.rows()), static_cast<int>(matrix.cols())) +
         data + "]\n";
}

Result<std::string> LensText(const CameraModel& camera) {
  const Eigen::Vector4d& f = camera.intrinsics();
  const LensCoefficients& k = camera.coefficients();
  const auto distortion = [&](int first) {
    return Map("distortion_parameters",
               {{"k1", k[first]}, {"k2", k[first + 1]}, {"p1", k[first + 2]}, {"p2", k[first + 3]}});
  };
  switch (camera.model()) {
    case DistortionModel::kNone:
    case DistortionModel::kRadialTangential:
      return "model_type: PINHOLE\n" + distortion(0) +
             Map("projection_parameters", {{"fx", f[0]}, {"fy", f[1]}, {"cx", f[2]}, {"cy", f[3]}});
    case DistortionModel::kMei:
      return "model_type: MEI\n" + Map("mirror_parameters", {{"xi", k[0]}}) + distortion(1) +
             Map("projection_parameters", {{"gamma1", f[0]}, {"gamma2", f[1]}, {"u0", f[2]}, {"v0", f[3]}});
    default:
      return Status::Input("InGVIO has no lens model " + std::string(ToString(camera.model())));
  }
}

std::string GnssText(const IngvioSettings& s) {
  // Its published values, but for what the settings have.
  return YamlLine("noise_rcv_clockbias", 2.0) + YamlLine("noise_rcv_clockbias_randomwalk", 0.2) +
         YamlLine("init_cov_rcv_clockbias", 2.0) + YamlLine("init_cov_rcv_clockbias_randomwalk", 1.0) +
         YamlLine("init_cov_yof", 0.015) +
         "gnss_ephem_topic: \"ephem\"\ngnss_glo_ephem_topic: \"glo_ephem\"\ngnss_meas_topic: \"range_meas\"\n"
         "gnss_iono_params_topic: \"iono_params\"\nrtk_gt_topic: \"receiver_lla\"\n" +
         YamlLine("gnss_elevation_thres", s.elevation_deg) + YamlLine("gnss_psr_std_thres", 8.0) +
         YamlLine("gnss_dopp_std_thres", 8.0) + YamlLine("gnss_track_num_thres", s.min_tracked_epochs) +
         YamlLine("use_fix_time_offset", 1) + YamlLine("gnss_local_offset", s.local_less_gpst_s) +
         YamlLine("gnss_chi2_test", s.gnss_gate ? 1 : 0) + YamlLine("gnss_strong_reject", 1) +
         YamlLine("gv_align_batch_size", s.align_epochs) + YamlLine("gv_align_max_iter", 25) +
         YamlLine("gv_align_conv_epsilon", 1e-5) + YamlLine("gv_align_vel_thres", 0.4) +
         YamlLine("psr_noise_amp", 1.0) + YamlLine("dopp_noise_amp", 1.0) +
         YamlLine("is_adjust_yof", s.estimate_yaw ? 1 : 0);
}

}  // namespace

Result<std::string> IngvioCameraFile(const RigCalibration& rig, const IngvioSettings& settings) {
  const Result<std::string> lens = LensText(rig.camera);
  ALIDADE_RETURN_IF_ERROR(lens.status());
  return kHead + std::string("imu_topic: \"imu\"\nimage_topic: \"image\"\ncamera_name: camera\n") + *lens +
         YamlLine("image_width", rig.camera.width_px()) + YamlLine("image_height", rig.camera.height_px()) +
         MatrixText("extrinsicRotation", rig.T_BC.rotation) +
         MatrixText("extrinsicTranslation", rig.T_BC.translation) +
         YamlLine("max_cnt", settings.max_features) + YamlLine("min_dist", 30) + YamlLine("freq", 0) +
         YamlLine("F_threshold", 1.0) + YamlLine("show_track", 0) + YamlLine("show_timer", 0) +
         YamlLine("timer_warning_thres", 50.0) + YamlLine("equalize", 1);
}

std::string IngvioFile(const IngvioSettings& s, const std::string& camera_file) {
  return kHead + std::string("imu_topic: \"imu\"\nfeature_topic: \"mono_feature\"\n") +
         YamlLine("cam_nums", 1) + "cam_left_file_path: \"" + camera_file + "\"\n" +
         YamlLine("max_sliding_window_poses", s.clones) + YamlLine("is_key_frame", 1) +
         YamlLine("max_landmark_features", 0) + YamlLine("enable_gnss", s.gnss ? 1 : 0) +
         YamlLine("noise_gyro", s.gyro_noise) + YamlLine("noise_accel", s.accel_noise) +
         YamlLine("noise_bias_gyro", s.gyro_walk) + YamlLine("noise_bias_accel", s.accel_walk) +
         YamlLine("init_cov_rot", 0.0) + YamlLine("init_cov_pos", 0.0) + YamlLine("init_cov_vel", 0.25) +
         YamlLine("init_cov_bg", 0.01) + YamlLine("init_cov_ba", 0.01) +
         YamlLine("init_cov_ext_rot", s.extrinsic_rotation_std) +
         YamlLine("init_cov_ext_pos", s.extrinsic_position_std_m) + YamlLine("gravity_norm", s.gravity_mps2) +
         YamlLine("max_imu_buffer_size", 3000) + YamlLine("init_imu_buffer_sp", s.start_samples) +
         YamlLine("trans_thres", 0.25) + YamlLine("huber_epsilon", 0.01) + YamlLine("conv_precision", 5e-8) +
         YamlLine("init_damping", 1e-3) + YamlLine("outer_loop_max_iter", 10) +
         YamlLine("inner_loop_max_iter", 10) + YamlLine("max_depth", 60.0) + YamlLine("min_depth", 0.2) +
         YamlLine("max_baseline_ratio", 80.0) + YamlLine("chi2_max_dof", 150) + YamlLine("chi2_thres", 0.95) +
         YamlLine("visual_noise", s.visual_noise) + YamlLine("frame_select_interval", 28) + GnssText(s);
}

}  // namespace alidade
