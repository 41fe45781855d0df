#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/estimator/measurement_log.h"
#include "core/estimator_config.h"
#include "eval/calibrate/camera_gyro_fit.h"
#include "eval/record/run_options.h"

namespace alidade {

/// Position of the camera on the body, as an estimator found it along the motion.
struct CameraLeverArm {
  Eigen::Vector3d p_BC = Eigen::Vector3d::Zero();        ///< [m]
  Eigen::Vector3d deviations = Eigen::Vector3d::Zero();  ///< [m], with the difference of the halves
  std::array<Eigen::Vector3d, 2> halves;                 ///< of the first and the second half alone
};

struct CalibratedCamera {
  CameraGyroFit fit;                                   ///< of the whole recording
  std::array<std::optional<CameraGyroFit>, 2> halves;  ///< of its halves alone
  /// Largest difference of the halves over its deviation, and the name of the coordinate; 0 without halves.
  double halves_sigma = 0;
  std::string halves_coordinate;
  std::optional<CameraLeverArm> lever_arm;  ///< empty where it is not observable or not asked for
  RigCalibration rig;                       ///< the log's, with what was found
  std::vector<std::string> remarks;
};

struct CameraCalibrationOptions {
  RunOptions run;
  bool lever_arm = true;
  bool readout = true;  ///< of a rolling shutter
  /// Starts for the focal length, times the given one.
  std::vector<double> focal_factors = {1};
  std::function<void(const std::string& line)> progress;  ///< may be empty
};

/// Name, unit and scale of a coordinate in texts: "time offset", "ms", 1e3.
struct CoordinateName {
  const char* name;
  const char* key;  ///< in files
  const char* unit;
  double scale;
};
[[nodiscard]] CoordinateName NameOfCoordinate(int coordinate);

/// Calibrates the camera of a recording in motion without a target: rotation, time offset, intrinsics and
/// readout time against the gyroscope (FindCameraGyro), whole and by halves; then the lever arm by
/// `config`'s estimator with online calibration, again whole and by halves. Deviations grow by what the
/// halves differ.
///
/// Errors (kInput): too little motion, or images that no calibration relates to the gyroscope.
Result<CalibratedCamera> CalibrateCamera(const EstimatorConfig& config, const MeasurementLog& log,
                                         const CameraCalibrationOptions& options);

}  // namespace alidade
