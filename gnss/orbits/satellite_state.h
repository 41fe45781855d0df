#pragma once

#include <Eigen/Core>

namespace alidade {

/// A satellite at its time of transmission, in the ECEF axes of that same time (no Sagnac rotation).
struct SatelliteState {
  Eigen::Vector3d position_E = Eigen::Vector3d::Zero();  ///< [m]
  Eigen::Vector3d velocity_E = Eigen::Vector3d::Zero();  ///< [m/s], in the rotating axes
  double clock_m = 0;    ///< c dt_S: clock ahead of system time, relativity included, group delay not
  double drift_mps = 0;  ///< c d(dt_S)/dt
};

}  // namespace alidade
