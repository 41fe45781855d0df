#pragma once

#include "eval/trajectory/trajectory.h"

namespace alidade {

/// A truth row (or truth interpolated to the estimate's stamp) and the estimate row compared with it.
struct StatePair {
  TrajectoryPoint truth;
  TrajectoryPoint estimate;
};

}  // namespace alidade
