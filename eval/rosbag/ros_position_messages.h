#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "core/position_fix.h"

namespace alidade {

/// A sensor_msgs/NavSatFix with a solution.
struct NavSatFix {
  TimeNs stamp_ns = 0;                                ///< of the header
  Eigen::Vector3d llh_deg = Eigen::Vector3d::Zero();  ///< latitude [deg], longitude [deg], height [m]
  Eigen::Matrix3d covariance_N = Eigen::Matrix3d::Identity();  ///< east, north, up at the position [m^2]
};
[[nodiscard]] std::string EncodeNavSatFix(const NavSatFix& fix);
/// The state of a NavSatFix: torn or out of range, no solution, or one. A covariance of unknown type is that
/// of deviations of 3 m, with SBAS 1 m, with GBAS 0.5 m, upwards twice that; of an approximated or diagonal
/// one the diagonal counts.
struct DecodedNavSatFix {
  bool sound = false;
  std::optional<NavSatFix> fix;
};
[[nodiscard]] DecodedNavSatFix DecodeNavSatFix(std::string_view bytes);

/// alidade/Position: a position in a frame of the sensor's own. PositionFix::sensor is not part of it.
[[nodiscard]] std::string EncodePosition(const PositionFix& fix);
[[nodiscard]] std::optional<PositionFix> DecodePosition(std::string_view bytes);

}  // namespace alidade
