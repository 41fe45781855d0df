#pragma once

#include <Eigen/Core>
#include <string>

#include "eval/dataset/dataset.h"

namespace alidade {

class Findings;

/// Calibrations that no rig has, of all cameras and the receiver: focal lengths, principal point, lever
/// arms and time offsets. Errors where no sensor on one body can be so, warnings where
/// it is unlikely.
void CheckRig(const Dataset& dataset, Findings* findings);

/// The lever arm [m, body frame] and time offset of a sensor that measures the position of one point, such as
/// "fix0", likewise. Precondition: two IMU samples.
void CheckAntenna(const Dataset& dataset, const std::string& sensor, const Eigen::Vector3d& p_BA,
                  double time_offset_s, Findings* findings);

}  // namespace alidade
