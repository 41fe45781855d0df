#pragma once

#include "core/config_schema.h"
#include "core/imu_sample.h"

namespace alidade {

/// Which white noise of the IMU an interval has.
enum class ImuNoiseModel {
  kSheet,     ///< that of the sheet
  kAdaptive,  ///< and what vibration in the interval adds (core/imu_vibration.h)
};

/// Gravity and how far the sensor sheet's noise is trusted.
struct ImuConfig {
  double gravity_mps2 = 9.81;
  ImuNoiseModel noise = ImuNoiseModel::kSheet;
  double noise_scale = 1.0;
  double random_walk_scale = 1.0;
  double max_gap_s = 0.5;
  bool guard = true;

  /// The sensor sheet's noise as far as it is trusted.
  [[nodiscard]] ImuNoise Scaled(const ImuNoise& sheet) const;
  void Describe(ConfigVisitor& visitor);
};

}  // namespace alidade
