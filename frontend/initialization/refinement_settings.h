#pragma once

#include "core/navigation_state.h"

namespace alidade {

/// What the refinement needs of the noise and the world.
struct RefinementSettings {
  Pose T_BC;
  double gravity_mps2 = 9.81;
  double accel_bias_std_mps2 = 0.1;
  double gyro_bias_std_radps = 0.1;
  double yaw_std_rad = 1e-3;     ///< gauge: of the newest state's yaw
  double position_std_m = 1e-3;  ///< gauge: of the newest state's position
};

}  // namespace alidade
