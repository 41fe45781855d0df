#pragma once

#include <Eigen/Core>

namespace alidade {

/// WGS 84 latitude and longitude [rad] and height above the ellipsoid [m]. By GeographicLib.
struct GeodeticPosition {
  double latitude_rad = 0;
  double longitude_rad = 0;
  double height_m = 0;
};

[[nodiscard]] GeodeticPosition ToGeodetic(const Eigen::Vector3d& position_E);
[[nodiscard]] Eigen::Vector3d ToEcef(const GeodeticPosition& position);

/// East, north, up axes N at an anchor: p_E = origin_E + R_EN p_N.
struct EnuFrame {
  Eigen::Vector3d origin_E = Eigen::Vector3d::Zero();
  Eigen::Matrix3d R_EN = Eigen::Matrix3d::Identity();

  [[nodiscard]] static EnuFrame At(const Eigen::Vector3d& origin_E);
  [[nodiscard]] Eigen::Vector3d ToEcef(const Eigen::Vector3d& position_N) const;
  [[nodiscard]] Eigen::Vector3d FromEcef(const Eigen::Vector3d& position_E) const;
};

/// Where a satellite stands in a receiver's sky.
struct Direction {
  double elevation_rad = 0;
  double azimuth_rad = 0;  ///< from north, clockwise, 0 to 2 pi
};

/// Direction from the frame's origin to a point.
[[nodiscard]] Direction DirectionTo(const EnuFrame& frame, const Eigen::Vector3d& position_E);

}  // namespace alidade
