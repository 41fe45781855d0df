#pragma once

#include <string>

#include "core/estimator/measurement_log.h"

namespace alidade {

/// SHA-256 (hex) over the log's calibration, IMU and tracks and, where it has GNSS, receiver, observations
/// (pseudorange, Doppler, C/N0) and broadcast ephemerides: equal digests mean identical input to every
/// estimator. Of GNSS it leaves out reported deviations, ionosphere parameters and precise products.
[[nodiscard]] std::string DigestOf(const MeasurementLog& log);

}  // namespace alidade
