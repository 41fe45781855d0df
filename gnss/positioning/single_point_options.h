#pragma once

#include "core/config_schema.h"
#include "core/robust_kernel.h"

namespace alidade {

/// Settings of the single-point solution.
struct SinglePointOptions {
  RobustKernel kernel = RobustKernel::kHuber;
  double kernel_scale_sigma = 1.5;
  double gate_probability = 0.999;
  double inter_system_walk = 0.05;  ///< [m / sqrt(s)]
  double max_position_std_m = 300;
  int max_iterations = 30;

  void Describe(ConfigVisitor& visitor);
};

}  // namespace alidade
