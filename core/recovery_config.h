#pragma once

#include "core/config_schema.h"

namespace alidade {

/// When an estimate is given up and a new start is sought; shared by both back ends.
struct RecoveryConfig {
  bool enabled = true;
  double max_speed_mps = 100.0;
  double max_gyro_bias_radps = 1.0;
  double max_accel_bias_mps2 = 5.0;
  double max_suspect_s = 3.0;

  void Describe(ConfigVisitor& visitor);
};

}  // namespace alidade
