#include "eval/simulation/sim_rig.h"

#include "core/lie.h"
#include "eval/dataset/sensor_yaml.h"

namespace alidade {
namespace {

/// The rig with the camera of a dataset folder.
Result<RigCalibration> RigOfDataset(const SimulatorConfig& config) {
  const Result<CameraSensor> sensor = ReadCameraSensor(config.trajectory_file + "/mav0/cam0/sensor.yaml");
  ALIDADE_RETURN_IF_ERROR(sensor.status());
  RigCalibration rig;
  rig.camera = sensor->camera;
  rig.T_BC = sensor->T_BC;
  rig.imu_noise = config.imu_noise;
  rig.camera_time_offset_s = sensor->time_offset_s;
  rig.line_delay_s = sensor->line_delay_s;
  return rig;
}

}  // namespace

double SimLineDelay(const SimulatorConfig& config, double recorded_s) {
  return config.render.line_delay_s != 0 ? config.render.line_delay_s : recorded_s;
}

Result<RigCalibration> MakeSimRig(const SimulatorConfig& config) {
  if (config.camera_view == SimCameraView::kDataset) {
    Result<RigCalibration> rig = RigOfDataset(config);
    if (rig.ok()) {
      rig->line_delay_s = SimLineDelay(config, rig->line_delay_s);
    }
    return rig;
  }
  const double* first = config.distortion_coefficients.data();
  const std::vector<double> coefficients(first, first + CoefficientCount(config.distortion));
  const Eigen::Vector4d intrinsics(config.focal_px, config.focal_px, 0.5 * config.width_px,
                                   0.5 * config.height_px);
  Result<CameraModel> camera =
      CameraModel::Create(config.distortion, intrinsics, coefficients, config.width_px, config.height_px);
  if (!camera.ok()) {
    return Status::Config("simulated camera: " + camera.message());
  }
  RigCalibration rig;
  rig.camera = *camera;
  // Columns: the camera's right, down and forward axes in the body frame (forward, left, up).
  if (config.camera_view == SimCameraView::kForward) {
    rig.T_BC.rotation << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  } else {
    rig.T_BC.rotation << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  }
  rig.T_BC.translation = config.camera_lever_arm_m;
  rig.imu_noise = config.imu_noise;
  rig.camera_time_offset_s = config.camera_time_offset_s;
  rig.line_delay_s = SimLineDelay(config, 0);
  return rig;
}

std::vector<ExtraCamera> MakeExtraCameras(const SimulatorConfig& config, const RigCalibration& rig) {
  Pose step;
  step.rotation = so3::Exp(config.camera_turn_rad * Eigen::Vector3d::UnitY());
  step.translation = config.camera_spacing_m;
  std::vector<ExtraCamera> cameras;
  Pose T_BC = rig.T_BC;
  for (int k = 1; k < config.camera_count; ++k) {
    T_BC = T_BC * step;
    cameras.push_back({rig.camera, T_BC, rig.camera_time_offset_s, {}});
  }
  return cameras;
}

}  // namespace alidade
