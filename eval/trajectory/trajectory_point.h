#pragma once

#include "eval/trajectory/trajectory.h"

namespace alidade {

/// A row with all that an estimate holds.
[[nodiscard]] inline TrajectoryPoint PointOf(const NavEstimate& estimate) {
  const Matrix15d& covariance = estimate.covariance;
  return {estimate.stamp_ns,
          estimate.nav,
          estimate.bias,
          covariance.topLeftCorner<6, 6>(),
          {covariance.block<3, 3>(6, 6), covariance.block<3, 3>(9, 9), covariance.block<3, 3>(12, 12)}};
}

}  // namespace alidade
