#pragma once

#include "core/config_schema.h"
#include "core/status.h"

namespace alidade {

/// How the images of a simulated camera are drawn: the hall, the lens' light and the sensor's noise. The
/// effects beyond a clean image are off by default (docs/renderer.md gives their equations).
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
  double gain = 1;
  double line_delay_s = 0;
  double vignetting = 0;
  double aperture_m = 0;
  double focus_distance_m = 3;
  // Exposure control.
  bool auto_exposure = false;
  double exposure_target_grey = 110;
  double exposure_max_s = 0.02;
  double gain_max = 8;
  int exposure_delay_frames = 2;
  double exposure_rate = 0.25;
  double exposure_band = 0.05;
  // Hall.
  double box_density_per_m2 = 0.25;
  double panel_density_per_m2 = 0.3;
  double column_density_per_m2 = 0.04;
  double texel_m = 0.006;
  double repetitive_share = 0;
  double bare_share = 0;
  // Light and what moves.
  double light_step = 0;
  double light_step_period_s = 6;
  double light_contrast = 1;
  double lamp_spacing_m = 0;
  double floor_gloss = 0;
  double moving_density_per_m2 = 0;
  double moving_speed_mps = 1;

  void Describe(ConfigVisitor& visitor);
  /// Relations between keys. Error: kConfig.
  [[nodiscard]] Status Validate() const;

 private:
  void DescribeCamera(ConfigVisitor& visitor);
  void DescribeExposureControl(ConfigVisitor& visitor);
  void DescribeHall(ConfigVisitor& visitor);
  void DescribeScene(ConfigVisitor& visitor);
};

}  // namespace alidade
