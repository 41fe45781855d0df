#pragma once

#include <optional>
#include <string>
#include <vector>

#include "eval/trajectory/trajectory.h"

namespace alidade {

/// A position that a receiver's own file holds.
struct FilePosition {
  TimeNs stamp_ns = 0;  ///< GPST
  Eigen::Vector3d position_E = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance_E = Eigen::Matrix3d::Identity();  ///< positive definite
};

/// Covariance in ECEF axes of a position with these deviations towards east, north and up, uncorrelated.
[[nodiscard]] Eigen::Matrix3d CovarianceFromDeviations(const Eigen::Vector3d& position_E,
                                                       const Eigen::Vector3d& deviations_enu_m);

/// Reads RTKLIB's .pos. The covariance is that of the row's six deviations; a row without them, or with a
/// deviation of zero, has the deviation that its quality Q suggests: 1 (fix) 0.02 m, 2 (float) 0.3 m, 3 and 4
/// (SBAS, DGPS) 1 m, 6 (PPP) 0.1 m, else 3 m, upwards twice that. Rows with a stamp not later than the one
/// before are passed over (a solution that is repeated). Columns are those that the header's line of labels
/// names, latitude(deg) or x-ecef(m) in GPST or UTC; without such a line latitude and longitude in degrees,
/// GPST. Errors (kInput): file and line of a label that is neither, or of a row that is torn or nowhere on
/// Earth; no row at all.
Result<std::vector<FilePosition>> ReadPositionRows(const std::string& path);

/// The same as positions in ENU at `anchor_E` (the first row when that is empty, which is then set), stamps
/// in IMU time: GPST + `time_offset_s`.
Result<Trajectory> ReadPositionFile(const std::string& path, double time_offset_s,
                                    std::optional<Eigen::Vector3d>* anchor_E);

}  // namespace alidade
