#include "eval/peers/ingvio_files.h"

#include <utility>
#include <vector>

#include "core/format.h"

namespace alidade {
namespace {

constexpr char kHead[] = "%YAML:1.0\n";  // as OpenCV's reader wants it

std::string Line(const char* key, double value) {
  return Format("%s: %.17g\n", key, value);
}

std::string Line(const char* key, int value) {
  return Format("%s: %d\n", key, value);
}

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
  return Line("noise_rcv_clockbias", 2.0) + Line("noise_rcv_clockbias_randomwalk", 0.2) +
         Line("init_cov_rcv_clockbias", 2.0) + Line("init_cov_rcv_clockbias_randomwalk", 1.0) +
         Line("init_cov_yof", 0.015) +
         "gnss_ephem_topic: \"ephem\"\ngnss_glo_ephem_topic: \"glo_ephem\"\ngnss_meas_topic: \"range_meas\"\n"
         "gnss_iono_params_topic: \"iono_params\"\nrtk_gt_topic: \"receiver_lla\"\n" +
         Line("gnss_elevation_thres", s.elevation_deg) + Line("gnss_psr_std_thres", 8.0) +
         Line("gnss_dopp_std_thres", 8.0) + Line("gnss_track_num_thres", s.min_tracked_epochs) +
         Line("use_fix_time_offset", 1) + Line("gnss_local_offset", s.local_less_gpst_s) +
         Line("gnss_chi2_test", s.gnss_gate ? 1 : 0) + Line("gnss_strong_reject", 1) +
         Line("gv_align_batch_size", s.align_epochs) + Line("gv_align_max_iter", 25) +
         Line("gv_align_conv_epsilon", 1e-5) + Line("gv_align_vel_thres", 0.4) + Line("psr_noise_amp", 1.0) +
         Line("dopp_noise_amp", 1.0) + Line("is_adjust_yof", s.estimate_yaw ? 1 : 0);
}

}  // namespace

Result<std::string> IngvioCameraFile(const RigCalibration& rig, const IngvioSettings& settings) {
  const Result<std::string> lens = LensText(rig.camera);
  ALIDADE_RETURN_IF_ERROR(lens.status());
  return kHead + std::string("imu_topic: \"imu\"\nimage_topic: \"image\"\ncamera_name: camera\n") + *lens +
         Line("image_width", rig.camera.width_px()) + Line("image_height", rig.camera.height_px()) +
         MatrixText("extrinsicRotation", rig.T_BC.rotation) +
         MatrixText("extrinsicTranslation", rig.T_BC.translation) + Line("max_cnt", settings.max_features) +
         Line("min_dist", 30) + Line("freq", 0) + Line("F_threshold", 1.0) + Line("show_track", 0) +
         Line("show_timer", 0) + Line("timer_warning_thres", 50.0) + Line("equalize", 1);
}

std::string IngvioFile(const IngvioSettings& s, const std::string& camera_file) {
  return kHead + std::string("imu_topic: \"imu\"\nfeature_topic: \"mono_feature\"\n") + Line("cam_nums", 1) +
         "cam_left_file_path: \"" + camera_file + "\"\n" + Line("max_sliding_window_poses", s.clones) +
         Line("is_key_frame", 1) + Line("max_landmark_features", 0) + Line("enable_gnss", s.gnss ? 1 : 0) +
         Line("noise_gyro", s.gyro_noise) + Line("noise_accel", s.accel_noise) +
         Line("noise_bias_gyro", s.gyro_walk) + Line("noise_bias_accel", s.accel_walk) +
         Line("init_cov_rot", 0.0) + Line("init_cov_pos", 0.0) + Line("init_cov_vel", 0.25) +
         Line("init_cov_bg", 0.01) + Line("init_cov_ba", 0.01) +
         Line("init_cov_ext_rot", s.extrinsic_rotation_std) +
         Line("init_cov_ext_pos", s.extrinsic_position_std_m) + Line("gravity_norm", s.gravity_mps2) +
         Line("max_imu_buffer_size", 3000) + Line("init_imu_buffer_sp", s.start_samples) +
         Line("trans_thres", 0.25) + Line("huber_epsilon", 0.01) + Line("conv_precision", 5e-8) +
         Line("init_damping", 1e-3) + Line("outer_loop_max_iter", 10) + Line("inner_loop_max_iter", 10) +
         Line("max_depth", 60.0) + Line("min_depth", 0.2) + Line("max_baseline_ratio", 80.0) +
         Line("chi2_max_dof", 150) + Line("chi2_thres", 0.95) + Line("visual_noise", s.visual_noise) +
         Line("frame_select_interval", 28) + GnssText(s);
}

}  // namespace alidade
