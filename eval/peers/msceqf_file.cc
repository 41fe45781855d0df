#include "eval/peers/msceqf_file.h"

#include "core/format.h"
#include "eval/peers/yaml_line.h"

namespace alidade {
namespace {

std::string List(const Eigen::Ref<const Eigen::VectorXd>& values) {
  std::string text;
  for (const double value : values) {
    text += Format("%s%.17g", text.empty() ? "[" : ", ", value);
  }
  return text + "]\n";
}

Result<std::string> CameraText(const RigCalibration& rig) {
  const CameraModel& camera = rig.camera;
  const bool equidistant = camera.model() == DistortionModel::kEquidistant;
  if (!equidistant && camera.model() != DistortionModel::kRadialTangential &&
      camera.model() != DistortionModel::kNone) {
    return Status::Input("MSCEqF has no lens model " + std::string(ToString(camera.model())));
  }
  std::string text = Format("distortion_model: %s\n", equidistant ? "equidistant" : "radtan");
  text += "distortion_coeffs: " + List(camera.coefficients().head<4>());
  text += Format("resolution: [%d, %d]\n", camera.width_px(), camera.height_px());
  text += "intrinsics: " + List(camera.intrinsics());
  text += YamlLine("timeshift_cam_imu", rig.camera_time_offset_s) + "T_imu_cam:\n";
  Eigen::Matrix4d T_BC = Eigen::Matrix4d::Identity();
  T_BC.topLeftCorner<3, 3>() = rig.T_BC.rotation;
  T_BC.topRightCorner<3, 1>() = rig.T_BC.translation;
  for (int row = 0; row < 4; ++row) {
    text += " - " + List(T_BC.row(row).transpose());
  }
  return text;
}

}  // namespace

Result<std::string> MsceqfFile(const RigCalibration& rig, const MsceqfSettings& s) {
  const Result<std::string> camera = CameraText(rig);
  ALIDADE_RETURN_IF_ERROR(camera.status());
  // Its published values, but for what the settings have. The misspelt keys are its own.
  Eigen::Matrix<double, 9, 1> start_std;
  start_std << 1e-2, 1e-2, 1e-4, 1e-2, 1e-2, 1e-2, 1e-4, 1e-4, 1e-4;  // attitude, velocity, position
  return *camera + "extended_pose_std: " + List(start_std) +
         "bias_std: " + List(Eigen::VectorXd::Constant(6, 1e-2)) +
         "extrinsics_std: " + List(Eigen::VectorXd::Constant(6, s.extrinsics_std)) +
         "intrinsics_std: " + List(Eigen::VectorXd::Ones(4)) +
         YamlLine("accelerometer_noise_density", s.accel_noise) +
         YamlLine("accelerometer_random_walk", s.accel_walk) +
         YamlLine("gyroscope_noise_density", s.gyro_noise) + YamlLine("gyroscope_random_walk", s.gyro_walk) +
         YamlLine("static_initializer_imu_window", 0.5) + YamlLine("static_initializer_acc_threshold", 0.05) +
         YamlLine("checker_disparity_window", 0.5) + YamlLine("checker_disparity_threshold", 2.0) +
         YamlLine("state_transition_order", -1) + YamlLine("imu_buffer_max_size", 1000) +
         "refine_traingulation: true\n" + YamlLine("feature_min_depth", 0.1) +
         YamlLine("feature_max_depth", 20.0) + YamlLine("feature_refinement_max_iterations", 20) +
         YamlLine("feature_refinement_tollerance", 1e-10) +
         "measurement_projection_method: unit_plane\nfeature_representation: anchored_euclidean\n" +
         YamlLine("pixel_standerd_deviation", s.pixel_noise_px) +
         "curvature_correction: true\nzero_velocity_update: enabled\n"
         "enable_camera_intrinsic_calibration: false\n" +
         YamlLine("gravity", s.gravity_mps2) + YamlLine("num_clones", s.clones) +
         "equalization_method: histogram\nfeature_detector: shi-tomasi\n" +
         YamlLine("optical_flow_pyramid_levels", 4) + YamlLine("detector_pyramid_levels", 2) +
         YamlLine("grid_x_size", 6) + YamlLine("grid_y_size", 6) +
         YamlLine("min_feature_pixel_distance", 10) + YamlLine("min_features", s.max_features) +
         YamlLine("max_features", s.max_features) + YamlLine("fast_threshold", 20) +
         YamlLine("shi_tomasi_quality_level", 0.8) + YamlLine("max_track_length", 200) +
         YamlLine("logger_level", 3);
}

}  // namespace alidade
