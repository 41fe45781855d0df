#pragma once

#include <cmath>

#include "core/imu_sample.h"

namespace alidade {

/// Mean and scatter of IMU samples; all zero without samples.
struct ImuStatistics {
  Eigen::Vector3d mean_gyro = Eigen::Vector3d::Zero();
  Eigen::Vector3d mean_accel = Eigen::Vector3d::Zero();
  double gyro_std_radps = 0;  ///< one axis, root mean square over the axes
  double accel_std_mps2 = 0;  ///< likewise
};

/// `samples`: any range of ImuSample with a size.
template <typename Samples>
[[nodiscard]] ImuStatistics MeasureImu(const Samples& samples) {
  ImuStatistics statistics;
  const double count = static_cast<double>(samples.size());
  for (const ImuSample& sample : samples) {
    statistics.mean_gyro += sample.gyro / count;
    statistics.mean_accel += sample.accel / count;
  }
  double gyro_variance = 0;
  double accel_variance = 0;
  for (const ImuSample& sample : samples) {
    gyro_variance += (sample.gyro - statistics.mean_gyro).squaredNorm() / (3 * count);
    accel_variance += (sample.accel - statistics.mean_accel).squaredNorm() / (3 * count);
  }
  statistics.gyro_std_radps = std::sqrt(gyro_variance);
  statistics.accel_std_mps2 = std::sqrt(accel_variance);
  return statistics;
}

}  // namespace alidade
