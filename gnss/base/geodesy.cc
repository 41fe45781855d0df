#include "gnss/base/geodesy.h"

#include <GeographicLib/Geocentric.hpp>
#include <algorithm>
#include <cmath>
#include <vector>

namespace alidade {
namespace {

constexpr double kDegree = M_PI / 180;

}  // namespace

GeodeticPosition ToGeodetic(const Eigen::Vector3d& p) {
  double latitude = 0;
  double longitude = 0;
  double height = 0;
  GeographicLib::Geocentric::WGS84().Reverse(p.x(), p.y(), p.z(), latitude, longitude, height);
  return {latitude * kDegree, longitude * kDegree, height};
}

Eigen::Vector3d ToEcef(const GeodeticPosition& position) {
  Eigen::Vector3d p;
  GeographicLib::Geocentric::WGS84().Forward(position.latitude_rad / kDegree,
                                             position.longitude_rad / kDegree, position.height_m, p.x(),
                                             p.y(), p.z());
  return p;
}

EnuFrame EnuFrame::At(const Eigen::Vector3d& origin_E) {
  double latitude = 0;
  double longitude = 0;
  double height = 0;
  std::vector<double> rotation(9);  // row-major, ENU to ECEF
  GeographicLib::Geocentric::WGS84().Reverse(origin_E.x(), origin_E.y(), origin_E.z(), latitude, longitude,
                                             height, rotation);
  EnuFrame frame;
  frame.origin_E = origin_E;
  frame.R_EN = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(rotation.data());
  return frame;
}

Direction DirectionTo(const EnuFrame& frame, const Eigen::Vector3d& position_E) {
  const Eigen::Vector3d e = frame.FromEcef(position_E).normalized();
  const double azimuth = std::atan2(e.x(), e.y());
  return {std::asin(std::clamp(e.z(), -1.0, 1.0)), azimuth < 0 ? azimuth + 2 * M_PI : azimuth};
}

Eigen::Vector3d EnuFrame::ToEcef(const Eigen::Vector3d& position_N) const {
  return origin_E + R_EN * position_N;
}

Eigen::Vector3d EnuFrame::FromEcef(const Eigen::Vector3d& position_E) const {
  return R_EN.transpose() * (position_E - origin_E);
}

}  // namespace alidade
