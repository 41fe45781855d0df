#include "eval/peers/vins_settings.h"

#include <cmath>

namespace alidade {

void SetVinsNoise(const ImuNoise& noise, double scale, double rate_hz, VinsSettings* settings) {
  settings->accel_noise = scale * noise.accel_noise_density_mps2_sqrthz * std::sqrt(2 * rate_hz);
  settings->gyro_noise = scale * noise.gyro_noise_density_radps_sqrthz * std::sqrt(2 * rate_hz);
  settings->accel_walk = noise.accel_random_walk_mps3_sqrthz * std::sqrt(rate_hz);
  settings->gyro_walk = noise.gyro_random_walk_radps2_sqrthz * std::sqrt(rate_hz);
}

}  // namespace alidade
