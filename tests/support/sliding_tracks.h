#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/support/scenario.h"

namespace alidade::test {

/// Tracks of 0.05 px in a hall, of which a share slides by some pixels a second, as where a near edge crosses
/// a far texture: the motion of gnss_rendered.yaml from its first moment on, without GNSS. `settings`: its
/// duration_s, path_m, outlier_rate and outlier_px.
inline Dataset SlidingTracks(unsigned seed, const std::vector<std::string>& settings) {
  std::vector<std::string> all = {"render.enabled=false", "gnss.rate_hz=0",     "rest_s=0",
                                  "landmark_layout=room", "landmark_count=600", "max_range_m=60",
                                  "pixel_noise_px=0.05",  "outlier_kind=drift"};
  all.insert(all.end(), settings.begin(), settings.end());
  const Result<SimulatorConfig> sim =
      LoadSimulatorConfig(ALIDADE_SOURCE_DIR "/configs/datasets/gnss_rendered.yaml", all);
  EXPECT_TRUE(sim.ok()) << sim.message();
  return SimulateOrDie(sim.ok() ? *sim : SimulatorConfig(), seed);
}

}  // namespace alidade::test
