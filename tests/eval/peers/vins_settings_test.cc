#include "eval/peers/vins_settings.h"

#include <gtest/gtest.h>

#include <cmath>

namespace alidade {
namespace {

// Midpoint integration over one interval: (n_0 + n_1) / 2 dt has the variance of a walk of the density,
// sigma^2 dt.
TEST(SetVinsNoise, GivesTheIntegralTheVarianceOfTheDensity) {
  ImuNoise noise;
  noise.gyro_noise_density_radps_sqrthz = 1e-3;
  noise.accel_noise_density_mps2_sqrthz = 2e-3;
  noise.gyro_random_walk_radps2_sqrthz = 3e-5;
  noise.accel_random_walk_mps3_sqrthz = 4e-4;
  VinsSettings settings;
  SetVinsNoise(noise, 6, 200, &settings);
  const double step_s = 1.0 / 200;
  const double variance = 2 * std::pow(settings.gyro_noise / 2 * step_s, 2);
  EXPECT_NEAR(variance, 36e-6 * step_s, 1e-15) << "six times the density";
  EXPECT_NEAR(settings.accel_noise / settings.gyro_noise, 2, 1e-12);
  EXPECT_NEAR(std::pow(settings.gyro_walk * step_s, 2), 9e-10 * step_s, 1e-18) << "walks are not scaled";
  EXPECT_NEAR(settings.accel_walk, 4e-4 * std::sqrt(200.0), 1e-12);
}

}  // namespace
}  // namespace alidade
