#pragma once

#include <string>
#include <vector>

#include "core/calibration.h"

namespace alidade {

/// How far a calibration is from the truth; magnitudes.
struct CalibrationError {
  double rotation_rad = 0;
  double translation_m = 0;
  double time_offset_s = 0;
  double focal_px = 0;  ///< of the worse axis
  double line_delay_s = 0;
};
[[nodiscard]] CalibrationError CompareCalibrations(const CameraCalibration& estimate,
                                                   const CameraCalibration& truth);

/// ",q_w,...": the columns of a row of calibration.csv after its stamp (docs/formats.md): what is estimated,
/// then the standard deviations of its error's coordinates.
[[nodiscard]] std::string CalibrationColumns(const CalibrationEstimate& estimate);
[[nodiscard]] std::string CalibrationFields(const CalibrationEstimate& estimate);

}  // namespace alidade
