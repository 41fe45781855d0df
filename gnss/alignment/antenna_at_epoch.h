#pragma once

#include "core/imu_propagation.h"
#include "gnss/model/measurement_model.h"

// The rows of InertialFitter's least squares.

namespace alidade {

/// The antenna at an epoch as the IMU predicts it from the state at the first epoch.
struct AntennaAtEpoch {
  using Jacobian = Eigen::Matrix<double, 3, 15>;

  Eigen::Vector3d position_E = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity_E = Eigen::Vector3d::Zero();
  Jacobian position_jacobian;               ///< over (phi, dp, dv, dbg, dba) at the epoch
  Jacobian velocity_jacobian;               ///< likewise
  Matrix15d chain = Matrix15d::Identity();  ///< d (phi, dp, dv, dbg, dba) at the epoch / d those at the first
};

/// `nav`, `bias`: at the first epoch; `interval`: from there to the epoch, null at the first itself;
/// gyro_radps: as measured at the epoch.
[[nodiscard]] AntennaAtEpoch PredictAntenna(const AntennaMount& mount, const Preintegration* interval,
                                            const Eigen::Vector3d& gravity_W, const NavState& nav,
                                            const ImuBias& bias, const Eigen::Vector3d& gyro_radps);

}  // namespace alidade
