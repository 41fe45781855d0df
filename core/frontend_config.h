#pragma once

#include "core/config_schema.h"

namespace alidade {

/// Images to tracks.
struct FrontendConfig {
  int max_features = 150;
  double min_distance_px = 20.0;
  double edge_share = 0.06;
  int grid_columns = 8;
  int grid_rows = 5;
  double corner_threshold = 6.0;
  int pyramid_levels = 3;
  int window_px = 15;
  int template_px = 25;
  double min_correlation = 0.8;
  double ransac_threshold_px = 1.5;
  double forward_backward_px = 0.0;
  bool equalize = false;
  bool imu_prediction = true;

  void Describe(ConfigVisitor& visitor);
};

}  // namespace alidade
