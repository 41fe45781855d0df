#pragma once

#include <Eigen/Core>

#include "core/navigation_state.h"

namespace alidade {

/// What one measurement of absolute position (GNSS epoch, position fix) did to an estimate. The corrections
/// of a filter whose model holds are independent of each other, and each has the covariance given here.
struct AbsoluteCorrection {
  NavState nav;                                          ///< at the measurement, after it
  Eigen::Vector3d change = Eigen::Vector3d::Zero();      ///< of p_WB [m]
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< of the change: that of p_WB before less after
};

[[nodiscard]] inline AbsoluteCorrection CorrectionBetween(const NavEstimate& before,
                                                          const NavEstimate& after) {
  return {after.nav, after.nav.p_WB - before.nav.p_WB,
          (before.covariance - after.covariance).block<3, 3>(3, 3)};
}

}  // namespace alidade
