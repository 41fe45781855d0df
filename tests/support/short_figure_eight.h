#pragma once

#include "eval/simulation/simulator_config.h"

namespace alidade::test {

/// 40 s of the default figure-8 at its speed: long enough for tracks to outlive every window.
inline SimulatorConfig ShortFigureEight() {
  SimulatorConfig config;
  config.duration_s = 40;
  config.path_m = 52.4;
  return config;
}

}  // namespace alidade::test
