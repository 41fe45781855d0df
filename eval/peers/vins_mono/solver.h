#pragma once

#include <vector>

#include "core/rig_calibration.h"
#include "eval/peers/vins_feature.h"
#include "eval/peers/vins_settings.h"
#include "eval/trajectory/trajectory.h"

namespace alidade::vins_mono {

/// VINS-Mono's solver: one object a process, since its settings are globals and it relies on its memory being
/// zero before its constructor runs.
class Solver {
 public:
  Solver(const RigCalibration& rig, const VinsSettings& settings);

  /// An IMU sample `step_s` after the one before.
  void AddImu(double step_s, const Eigen::Vector3d& gyro, const Eigen::Vector3d& accel);
  /// The features of the image at `time_s` of the camera's clock, to which the IMU has been delivered.
  void AddImage(const std::vector<VinsFeature>& features, double time_s);

  /// Initialised and not lost.
  [[nodiscard]] bool running() const;
  [[nodiscard]] double time_offset_s() const;
  /// State of the newest image; no stamp and no covariance.
  [[nodiscard]] TrajectoryPoint Newest() const;
};

}  // namespace alidade::vins_mono
