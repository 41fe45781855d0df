#include "eval/metrics/evaluation_export.h"

#include "eval/files/output_file.h"
#include "eval/trajectory/trajectory_export.h"

namespace alidade {

Status WriteForOtherTools(const Trajectory& truth, const Trajectory& estimate, TrajectoryAlignment alignment,
                          const std::string& folder) {
  const std::string header = "# timestamp tx ty tz qx qy qz qw\n";
  const std::string align =
      alignment == TrajectoryAlignment::kPos ? "none" : std::string(ToString(alignment));
  ALIDADE_RETURN_IF_ERROR(
      WriteLoneFileAtomically(folder + "/stamped_groundtruth.txt", header + FormatTum(truth)));
  ALIDADE_RETURN_IF_ERROR(
      WriteLoneFileAtomically(folder + "/stamped_traj_estimate.txt", header + FormatTum(estimate)));
  return WriteLoneFileAtomically(folder + "/eval_cfg.yaml",
                                 "align_type: " + align + "\nalign_num_frames: -1\n");
}

}  // namespace alidade
