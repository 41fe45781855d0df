#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

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

/// Types of other programs that hold a position in a frame of their own, such as motion capture and UWB:
/// geometry_msgs/PointStamped, PoseStamped, PoseWithCovarianceStamped, TransformStamped, nav_msgs/Odometry.
[[nodiscard]] const std::vector<std::string>& LocalPositionTypes();
/// Whether messages of one of LocalPositionTypes hold a covariance of the position.
[[nodiscard]] bool LocalPositionHasCovariance(std::string_view type);
struct LocalPosition {
  TimeNs stamp_ns = 0;                            ///< of the header
  Eigen::Vector3d p_A = Eigen::Vector3d::Zero();  ///< of the moving frame's origin [m]
  /// Of p_A [m^2]; nothing: the type has none, or it is not positive definite, such as zeros for unknown.
  std::optional<Eigen::Matrix3d> covariance;
};
/// `type`: one of LocalPositionTypes.
[[nodiscard]] std::optional<LocalPosition> DecodeLocalPosition(std::string_view type, std::string_view bytes);

}  // namespace alidade
