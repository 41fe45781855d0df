#pragma once

#include <Eigen/Core>

#include "core/preintegration.h"

namespace alidade {

/// The state at the end of a preintegrated interval that begins at `nav`, without the IMU's noise:
///
///   R' = R gamma(b),  p' = p + v T + g T^2 / 2 + R alpha(b),  v' = v + g T + R beta(b)
///
/// `jacobian`: 15x15 over (phi, dp, dv, dbg, dba) of both, may be null.
[[nodiscard]] NavState CarryState(const Preintegration& preintegration, const NavState& nav,
                                  const ImuBias& bias, const Eigen::Vector3d& gravity_W, Matrix15d* jacobian);

}  // namespace alidade
