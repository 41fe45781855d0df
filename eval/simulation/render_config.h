#pragma once

#include "core/config_schema.h"

namespace alidade {

/// How the images of a simulated camera are drawn: the hall, the lens' light and the sensor's noise.
struct RenderConfig {
  bool enabled = false;  ///< images instead of simulated tracks
  // Camera.
  double exposure_s = 0.004;
  int samples = 4;
  double brightness = 1;
  double brightness_swing = 0;
  double brightness_period_s = 8;
  double read_noise_grey = 1;
  double shot_noise_grey = 0.03;
  // Hall.
  double box_density_per_m2 = 0.25;
  double panel_density_per_m2 = 0.3;
  double column_density_per_m2 = 0.04;
  double texel_m = 0.006;

  void Describe(ConfigVisitor& visitor);
};

}  // namespace alidade
