#pragma once

#include <string>

#include "eval/metrics.h"
#include "eval/trajectory.h"

namespace alidade {

/// TUM text, as evo and the rpg tools read it: "stamp_s x y z qx qy qz qw", the stamp printed from the
/// integer with nine decimals, numbers the shortest that read back equal, w >= 0. No header.
[[nodiscard]] std::string FormatTum(const Trajectory& trajectory);

/// Writes what other tools evaluate into `folder`: stamped_groundtruth.txt, stamped_traj_estimate.txt and
/// eval_cfg.yaml of rpg_trajectory_evaluation, whose two text files evo_ape and evo_rpe read as `tum`.
/// Alignment pos has no name there and is written as none. Errors: kOutput.
Status WriteForOtherTools(const Trajectory& truth, const Trajectory& estimate, Alignment alignment,
                          const std::string& folder);

}  // namespace alidade
