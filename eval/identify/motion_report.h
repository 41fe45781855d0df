#pragma once

#include <string>

#include "core/status.h"
#include "eval/identify/motion_noise.h"

namespace alidade {

/// Noises with intervals, the halves' predictions, remarks, and the settings to use, for a terminal.
[[nodiscard]] std::string MotionNoiseTable(const MotionNoise& noise);

/// Writes identify.json, innovations.csv, nis.svg and mav0/imu0/sensor.yaml into `folder` (formats:
/// docs/formats.md). `rate_hz`: of the IMU, for the sheet. kOutput: a file could not be written.
Status WriteMotionNoise(const MotionNoise& noise, const std::string& dataset, double rate_hz,
                        const std::string& folder);

}  // namespace alidade
