#include "gnss/positioning/position_file.h"

#include <cmath>

#include "core/format.h"

namespace alidade {
namespace {

/// Square root that keeps the sign, as RTKLIB writes covariances.
double SignedRoot(double covariance) {
  return covariance < 0 ? -std::sqrt(-covariance) : std::sqrt(covariance);
}

/// Deviations and signed roots of covariances in the file's order n, e, u, ne, eu, un of an ENU matrix.
std::string Deviations(const Eigen::Matrix3d& c, const char* format) {
  const double values[] = {c(1, 1), c(0, 0), c(2, 2), c(1, 0), c(0, 2), c(2, 1)};
  std::string text;
  for (const double value : values) {
    std::string word = Format("%.*f", format[0] - '0', SignedRoot(value));
    text += Format(" %*s", format[1] - '0', word.c_str());
  }
  return text;
}

}  // namespace

std::string PositionFileHeader(const std::vector<std::string>& remarks) {
  std::string text;
  for (const std::string& remark : remarks) {
    text += "% " + remark + "\n";
  }
  text +=
      "% (lat/lon/height=WGS84/ellipsoidal,Q=1:fix,2:float,3:sbas,4:dgps,5:single,6:ppp,ns=# of "
      "satellites)\n";
  text +=
      "%  GPST                  latitude(deg) longitude(deg)  height(m)   Q  ns   sdn(m)   sde(m)   sdu(m)  "
      "sdne(m)  sdeu(m)  sdun(m) age(s)  ratio    vn(m/s)    ve(m/s)    vu(m/s)      sdvn     sdve     sdvu  "
      "  "
      "sdvne    sdveu    sdvun\n";
  return text;
}

void AppendPosition(const SinglePointSolution& s, std::string* text) {
  const GeodeticPosition place = ToGeodetic(s.position_E);
  const Eigen::Matrix3d R_NE = EnuFrame::At(s.position_E).R_EN.transpose();
  const Eigen::Vector3d v = R_NE * s.velocity_E;
  *text += FormatGpsTime(s.stamp_ns, 3) +
           Format(" %14.9f %14.9f %10.4f %3d %3d", place.latitude_rad * 180 / M_PI,
                  place.longitude_rad * 180 / M_PI, place.height_m, 5, s.used) +
           Deviations(R_NE * s.position_covariance_E * R_NE.transpose(), "48") +
           Format(" %6.2f %6.1f", 0.0, 0.0) + Format(" %10.5f %10.5f %10.5f", v.y(), v.x(), v.z()) + " " +
           Deviations(R_NE * s.velocity_covariance_E * R_NE.transpose(), "58") + "\n";
}

}  // namespace alidade
