#pragma once

#include <string>

#include "core/estimator/measurement_log.h"
#include "core/status.h"

namespace alidade {

struct LogTables;

/// SHA-256 (hex) over the log's calibration, IMU and tracks and, where it has GNSS, receiver, observations
/// (pseudorange, Doppler, C/N0) and broadcast ephemerides: equal digests mean identical input to every
/// estimator. Of GNSS it leaves out reported deviations, ionosphere parameters and precise products.
[[nodiscard]] std::string DigestOf(const MeasurementLog& log);
/// The same of a log whose long tables are elsewhere. Errors: the tables'.
Result<std::string> DigestOf(const MeasurementLog& log, const LogTables& tables);

}  // namespace alidade
