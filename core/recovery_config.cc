#include "core/recovery_config.h"

namespace alidade {

void RecoveryConfig::Describe(ConfigVisitor& visitor) {
  visitor.Boolean(
      {"enabled", "-", "re-initialise a lost estimate from the data that follow; otherwise the run ends"},
      &enabled);
  visitor.Real({"max_speed_mps", "m/s", "an estimate with a higher speed is lost"}, &max_speed_mps, 1, 1e4);
  visitor.Real({"max_gyro_bias_radps", "rad/s", "an estimate with a larger bias is lost"},
               &max_gyro_bias_radps, 1e-3, 10);
  visitor.Real({"max_accel_bias_mps2", "m/s^2", "an estimate with a larger bias is lost"},
               &max_accel_bias_mps2, 1e-3, 100);
  visitor.Real({"max_suspect_s", "s",
                "an estimate that is contradicted by its tracks for this time, without a frame that supports "
                "it, is lost"},
               &max_suspect_s, 0.1, 1e4);
}

}  // namespace alidade
