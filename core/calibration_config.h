#pragma once

#include "core/config_schema.h"

namespace alidade {

/// Which parameters of the camera are estimated along with the motion (core/calibration.h). The standard
/// deviations are the uncertainty of the given calibration, one for each axis or coefficient.
struct CalibrationConfig {
  bool extrinsics = false;
  bool time_offset = false;
  bool line_delay = false;
  bool intrinsics = false;
  bool watch = false;
  double rotation_std_rad = 0.035;
  double translation_std_m = 0.03;
  double time_offset_std_s = 0.01;
  double line_delay_std_s = 5e-6;
  double focal_std_px = 5.0;
  double center_std_px = 5.0;
  double distortion_std = 0.02;

  [[nodiscard]] bool any() const { return extrinsics || time_offset || line_delay || intrinsics; }
  /// Whether the given calibration is tested (core/calibration_watch.h): only one that is not estimated.
  [[nodiscard]] bool watched() const { return watch && !any(); }
  void Describe(ConfigVisitor& visitor);
};

}  // namespace alidade
