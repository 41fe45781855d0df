#pragma once

#include <memory>

#include "core/time.h"
#include "eval/dataset/dataset.h"
#include "eval/simulation/continuous_trajectory.h"

namespace alidade {

/// A simulated sequence and the motion it was made from.
struct Simulation {
  Dataset dataset;
  std::shared_ptr<const ContinuousTrajectory> motion;
  TimeNs motion_start_ns = 0;  ///< stamp of the motion's time 0
};

}  // namespace alidade
