#pragma once

#include <string>

#include "core/status.h"
#include "eval/calibrate/camera_calibration.h"

namespace alidade {

/// What `calibrate` prints: a row a coordinate with its change from the given sheet, its deviation and what
/// the halves of the recording found, and the new sheet.
[[nodiscard]] std::string CalibratedCameraTable(const CalibratedCamera& camera, const RigCalibration& given,
                                                double rate_hz);

/// Writes calibrate.json and mav0/cam0/sensor.yaml below `folder`.
Status WriteCalibratedCamera(const CalibratedCamera& camera, const RigCalibration& given,
                             const std::string& dataset, double rate_hz, const std::string& folder);

}  // namespace alidade
