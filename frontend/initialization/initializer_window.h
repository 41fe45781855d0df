#pragma once

#include <vector>

#include "core/navigation_state.h"
#include "core/time.h"

namespace alidade {

/// The states a dynamic initialisation found over its window, in the world of the returned state.
struct InitializerWindow {
  std::vector<TimeNs> stamps_ns;  ///< IMU time of the camera frames used, the returned one last
  std::vector<NavState> states;
  double relative_scale_std = 0;  ///< of the window's size
};

}  // namespace alidade
