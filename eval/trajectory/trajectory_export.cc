#include "eval/trajectory/trajectory_export.h"

#include <Eigen/Geometry>

#include "eval/files/output_file.h"

namespace alidade {

void AppendTum(const TrajectoryPoint& point, std::string* text) {
  const Eigen::Vector3d& p = point.nav.p_WB;
  const Eigen::Vector4d xyzw = Eigen::Quaterniond(point.nav.R_WB).normalized().coeffs();
  const double sign = xyzw[3] < 0 ? -1 : 1;
  *text += FormatSeconds(point.stamp_ns);
  for (const double value :
       {p.x(), p.y(), p.z(), sign * xyzw[0], sign * xyzw[1], sign * xyzw[2], sign * xyzw[3]}) {
    *text += " " + ShortestDouble(value);
  }
  *text += "\n";
}

std::string FormatTum(const Trajectory& trajectory) {
  std::string text;
  for (const TrajectoryPoint& point : trajectory.points) {
    AppendTum(point, &text);
  }
  return text;
}

}  // namespace alidade
