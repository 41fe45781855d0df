#pragma once

#include <optional>
#include <string>
#include <vector>

#include "eval/dataset/sensor_yaml.h"

namespace alidade {

/// Calibration in the files of other programs.
struct ImportedCalibration {
  std::optional<ImuSensor> imu;
  /// VINS gives the deviations of single samples, not densities: divide by the square root of the rate
  /// (DensitiesOf).
  bool imu_is_per_sample = false;
  std::optional<CameraSensor> camera;
};

/// Reads calibration files, each recognised by its keys; the first one with a value counts. `camera`
/// chooses among several: cam0, cam1.
///
///   Kalibr      camchain (T_cam_imu, timeshift_cam_imu), omni-radtan as the model mei, ds as double-sphere,
///               eucm; imu.yaml
///   OpenVINS    estimator_config (names the two others), kalibr_imucam_chain (T_imu_cam), kalibr_imu_chain
///   VINS        model_type PINHOLE, MEI or KANNALA_BRANDT; body_T_cam0 or extrinsicRotation and
///               extrinsicTranslation; acc_n, gyr_n, acc_w, gyr_w; td; cam0_calib names the camera's file
///               (of cam1: body_T_cam1, cam1_calib)
///   Basalt      JSON (eval/dataset/basalt_calibration.h)
///
/// Errors (kInput): a file that is none of these, lacks a key or holds a value that sensor.yaml would not
/// take.
Result<ImportedCalibration> ImportCalibration(const std::vector<std::string>& paths,
                                              const std::string& camera = "cam0");

/// Converts standard deviations of single samples at `rate_hz` to densities: sigma / sqrt(rate). VINS defines
/// the step of a bias over one sample as its deviation times the sample's duration.
[[nodiscard]] ImuNoise DensitiesOf(const ImuNoise& per_sample, double rate_hz);

}  // namespace alidade
