#pragma once

#include "core/config_schema.h"
#include "core/robust_kernel.h"

namespace alidade {

/// Whose run gives the batch estimate its initial values; it is set by its own section.
enum class BatchInitial { kFilter, kSmoother };

/// The batch estimate of a whole log.
struct BatchConfig {
  BatchInitial initial = BatchInitial::kFilter;
  int max_iterations = 50;
  double tolerance_sigma = 0.01;
  RobustKernel robust_kernel = RobustKernel::kNone;
  double gate_probability = 0.9999;
  bool filtering_bound = true;

  void Describe(ConfigVisitor& visitor);
};

}  // namespace alidade
