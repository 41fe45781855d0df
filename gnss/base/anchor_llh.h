#pragma once

#include <Eigen/Core>
#include <numbers>

#include "gnss/base/geodesy.h"

namespace alidade {

/// The ENU frame at latitude [deg], longitude [deg] and height above the ellipsoid [m], WGS 84.
[[nodiscard]] inline EnuFrame EnuFrameAtLlh(const Eigen::Vector3d& llh_deg) {
  constexpr double kDegree = std::numbers::pi / 180;
  return EnuFrame::At(ToEcef({kDegree * llh_deg[0], kDegree * llh_deg[1], llh_deg[2]}));
}

/// Latitude [deg], longitude [deg] and height [m] of a point.
[[nodiscard]] inline Eigen::Vector3d LlhDegOf(const Eigen::Vector3d& position_E) {
  constexpr double kDegree = std::numbers::pi / 180;
  const GeodeticPosition position = ToGeodetic(position_E);
  return {position.latitude_rad / kDegree, position.longitude_rad / kDegree, position.height_m};
}

}  // namespace alidade
