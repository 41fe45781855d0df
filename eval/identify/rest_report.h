#pragma once

#include <string>

#include "core/status.h"
#include "eval/identify/rest_noise.h"

namespace alidade {

/// Span, coefficients with intervals and remarks, for a terminal.
[[nodiscard]] std::string RestNoiseTable(const RestNoise& noise);

/// Writes identify.json, allan.csv, allan.svg and mav0/imu0/sensor.yaml into `folder` (formats:
/// docs/formats.md). kOutput: a file could not be written.
Status WriteRestNoise(const RestNoise& noise, const std::string& dataset, const std::string& folder);

}  // namespace alidade
