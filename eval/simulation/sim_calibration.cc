#include "eval/simulation/sim_calibration.h"

#include <vector>

#include "core/estimator/measurement.h"
#include "core/lie.h"
#include "core/random.h"

namespace alidade {

Result<RigCalibration> MiscalibratedRig(const SimulatorConfig& config, const RigCalibration& rig,
                                        std::uint64_t seed) {
  RandomStream random(seed, "calibration_error");
  const Eigen::Vector3d axis = random.Normal3().normalized();
  const Eigen::Vector3d direction = random.Normal3().normalized();
  const auto sign = [&random] { return random.Chance(0.5) ? 1.0 : -1.0; };
  RigCalibration wrong = rig;
  wrong.T_BC.rotation = rig.T_BC.rotation * so3::Exp(config.calibration_rotation_error_rad * axis);
  wrong.T_BC.translation += config.calibration_translation_error_m * direction;
  wrong.camera_time_offset_s += config.calibration_time_error_s * sign();
  // A stream of its own: the errors of a camera are as without an antenna.
  const Eigen::Vector3d antenna_error =
      config.calibration_antenna_error_m *
      RandomStream(seed, "calibration_error/antenna").Normal3().normalized();
  wrong.gnss.p_BA += antenna_error;
  ForEachSensorEntry([&](auto entry, Sensor) {
    if constexpr (HasLeverArm<typename decltype(entry)::Whitened>) {
      for (auto& sensor : entry.Sensors(wrong)) {
        sensor.p_BA += antenna_error;
      }
    }
  });
  Eigen::Vector4d intrinsics = rig.camera.intrinsics();
  for (int i = 0; i < 4; ++i) {
    intrinsics[i] +=
        sign() * (i < 2 ? config.calibration_focal_error_px : config.calibration_center_error_px);
  }
  wrong.line_delay_s += config.calibration_line_delay_error_s * sign();
  if (intrinsics != rig.camera.intrinsics()) {
    const double* first = rig.camera.coefficients().data();
    Result<CameraModel> camera =
        CameraModel::Create(rig.camera.model(), intrinsics,
                            std::vector<double>(first, first + CoefficientCount(rig.camera.model())),
                            rig.camera.width_px(), rig.camera.height_px());
    if (!camera.ok()) {
      return Status::Config("calibration_focal_error_px: " + camera.message());
    }
    wrong.camera = *camera;
  }
  return wrong;
}

}  // namespace alidade
