#pragma once

#include "core/config_schema.h"
#include "core/robust_kernel.h"

namespace alidade {

/// Position fixes in an estimator (core/position_fix.h): noise, gate and kernel, alignment. Shared by both
/// back ends.
struct FixConfig {
  bool enabled = false;
  double std_scale = 1;
  double std_floor_m = 0.005;
  double gate_probability = 0.999;
  int max_refused_run = 5;
  RobustKernel robust_kernel = RobustKernel::kHuber;
  double robust_scale_sigma = 3;
  // Alignment (gnss/alignment/fix_aligner.h).
  int align_min_fixes = 5;
  double align_window_s = 30;
  double align_max_yaw_std_rad = 0.1;
  double align_inflation = 1.5;
  // Smoother.
  double max_interpolation_s = 0.3;

  void Describe(ConfigVisitor& visitor);
  /// Takes `factor` times the noise of `given`.
  void AssumeNoise(const FixConfig& given, double factor) {
    std_scale = factor * given.std_scale;
    std_floor_m = factor * given.std_floor_m;
  }
};

}  // namespace alidade
