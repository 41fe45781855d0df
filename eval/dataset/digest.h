#pragma once

#include <string>

#include "core/estimator/measurement_log.h"
#include "core/status.h"

namespace alidade {

struct LogTables;

/// SHA-256 (hex) over the log's calibration, IMU and tracks and, where it has them, further cameras with
/// their tracks, position fixes with their sensors, and of GNSS the receiver, observations (pseudorange,
/// Doppler, C/N0) and broadcast ephemerides. Equal digests mean that these are equal. Inputs can still differ
/// in what is left out: reported deviations of GNSS, ionosphere parameters and precise products.
[[nodiscard]] std::string DigestOf(const MeasurementLog& log);
/// The same of a log whose long tables are elsewhere. Errors: the tables'.
Result<std::string> DigestOf(const MeasurementLog& log, const LogTables& tables);

}  // namespace alidade
