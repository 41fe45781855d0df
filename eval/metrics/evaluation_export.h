#pragma once

#include <string>

#include "eval/metrics/trajectory_alignment.h"
#include "eval/trajectory/trajectory.h"

namespace alidade {

/// Writes the files for other evaluation tools into `folder`: stamped_groundtruth.txt,
/// stamped_traj_estimate.txt and eval_cfg.yaml of rpg_trajectory_evaluation, whose two text files evo_ape and
/// evo_rpe read as `tum`. Alignment pos has no name there and is written as none. Errors: kOutput.
Status WriteForOtherTools(const Trajectory& truth, const Trajectory& estimate, TrajectoryAlignment alignment,
                          const std::string& folder);

}  // namespace alidade
