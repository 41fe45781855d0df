#include "eval/trajectory_export.h"

#include <Eigen/Geometry>

#include "eval/output_file.h"

namespace alidade {

std::string FormatTum(const Trajectory& trajectory) {
  std::string text;
  for (const TrajectoryPoint& point : trajectory.points) {
    const Eigen::Vector3d& p = point.nav.p_WB;
    const Eigen::Vector4d xyzw = Eigen::Quaterniond(point.nav.R_WB).normalized().coeffs();
    const double sign = xyzw[3] < 0 ? -1 : 1;
    text += FormatSeconds(point.stamp_ns);
    for (const double value :
         {p.x(), p.y(), p.z(), sign * xyzw[0], sign * xyzw[1], sign * xyzw[2], sign * xyzw[3]}) {
      text += " " + ShortestDouble(value);
    }
    text += "\n";
  }
  return text;
}

Status WriteForOtherTools(const Trajectory& truth, const Trajectory& estimate, Alignment alignment,
                          const std::string& folder) {
  const std::string header = "# timestamp tx ty tz qx qy qz qw\n";
  const std::string align = alignment == Alignment::kPos ? "none" : std::string(ToString(alignment));
  ALIDADE_RETURN_IF_ERROR(
      WriteFileAtomically(folder + "/stamped_groundtruth.txt", header + FormatTum(truth)));
  ALIDADE_RETURN_IF_ERROR(
      WriteFileAtomically(folder + "/stamped_traj_estimate.txt", header + FormatTum(estimate)));
  return WriteFileAtomically(folder + "/eval_cfg.yaml", "align_type: " + align + "\nalign_num_frames: -1\n");
}

}  // namespace alidade
