#pragma once

#include <optional>
#include <string>

#include "eval/trajectory/trajectory.h"

namespace alidade {

/// Reads RTKLIB's .pos as positions in ENU at `anchor_E` (its first row when that is empty, which is then
/// set), stamps in IMU time: GPST + `time_offset_s`. Rows whose stamp is not later than the previous one are
/// skipped (repeated solutions). Errors (kInput): file and line of a row that is torn or far from the Earth's
/// surface; no row.
Result<Trajectory> ReadPositionFile(const std::string& path, double time_offset_s,
                                    std::optional<Eigen::Vector3d>* anchor_E);

}  // namespace alidade
