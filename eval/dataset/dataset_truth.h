#pragma once

#include <string>

#include "core/status.h"
#include "eval/dataset/dataset.h"

namespace alidade {

class Findings;

// The truth of a sequence: folder state_groundtruth_estimate0 of `mav`; mocap0 is read too.

/// Reads the first of data.csv, data_pose.csv and data_position.csv. Errors (kInput): those of
/// ReadTrajectory; a folder without any of them. Covariances beside it are read and written too
/// (eval/trajectory/truth_covariance.h).
Status ReadTruthFolder(const std::string& mav, const DatasetStorage& storage, Dataset* dataset);
Status WriteTruthFolder(const Dataset& dataset, const std::string& mav);

/// The text of data.csv, data_pose.csv or data_position.csv, whichever holds what the trajectory has.
[[nodiscard]] std::string TruthCsv(const Trajectory& truth);

/// Rate, gaps, the covered part of the IMU's time, length of the path; a warning without truth.
void CheckTruth(const Dataset& dataset, Findings* findings);

}  // namespace alidade
