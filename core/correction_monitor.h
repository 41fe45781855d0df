#pragma once

#include <Eigen/Core>
#include <deque>
#include <optional>

#include "core/navigation_state.h"

namespace alidade {

/// What measurements of absolute position did to an estimate: the change of (position, velocity) and its
/// covariance under the model, which is that of the estimate before less that after.
struct AbsoluteCorrection {
  TimeNs stamp_ns = 0;
  Vector6d change = Vector6d::Zero();
  Matrix6d covariance = Matrix6d::Zero();
};

}  // namespace alidade
