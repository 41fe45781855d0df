#include "core/imu_config.h"

namespace alidade {

void ImuConfig::Describe(ConfigVisitor& visitor) {
  visitor.Real({"gravity_mps2", "m/s^2", "magnitude of gravity; W has z up"}, &gravity_mps2, 9.7, 9.9);
  visitor.Enumeration({"noise", "-",
                       "white noise of the IMU: that of the sensor sheet, or `adaptive` with what vibration "
                       "adds that the sample rate does not resolve"},
                      &noise, {{"sheet", ImuNoiseModel::kSheet}, {"adaptive", ImuNoiseModel::kAdaptive}});
  visitor.Real({"noise_scale", "-",
                "factor on the white-noise densities of the sensor sheet, which assume a stationary IMU; "
                "larger on vehicles"},
               &noise_scale, 0.1, 1000);
  visitor.Real({"random_walk_scale", "-", "factor on the bias random walks of the sensor sheet"},
               &random_walk_scale, 0.01, 1000);
  visitor.Real({"max_gap_s", "s", "a longer interval without IMU samples is reported as a gap"}, &max_gap_s,
               0.01, 10);
  visitor.Boolean({"guard", "-",
                   "replace single samples that their neighbours contradict (spikes) before they reach an "
                   "estimator; counted and reported"},
                  &guard);
}

ImuNoise ImuConfig::Scaled(const ImuNoise& sheet) const {
  return {sheet.gyro_noise_density_radps_sqrthz * noise_scale,
          sheet.accel_noise_density_mps2_sqrthz * noise_scale,
          sheet.gyro_random_walk_radps2_sqrthz * random_walk_scale,
          sheet.accel_random_walk_mps3_sqrthz * random_walk_scale, noise == ImuNoiseModel::kAdaptive};
}

}  // namespace alidade
