#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "core/imu_sample.h"
#include "core/init_config.h"
#include "core/lie.h"

namespace alidade {

/// Statistics of the calm seconds of an IMU, from one pass that keeps one number a second. A second is calm
/// when its rates and specific forces spread less than the static start allows (InitConfig) and its mean rate
/// is below kMostBias. Neglected: steady motion, which spreads as little as rest; medians over seconds bear
/// some of it.
class QuietSeconds {
 public:
  /// Rising stamps.
  void Add(const ImuSample& sample);

  /// Of calm seconds so far; the one at hand is not among them.
  [[nodiscard]] std::size_t count() const { return forces_.size(); }
  /// Of seconds so far that count: of ten samples or more.
  [[nodiscard]] std::size_t judged() const { return judged_; }
  /// Median norm of the mean specific force over calm seconds [m/s^2]; none from fewer than three.
  [[nodiscard]] std::optional<double> SpecificForce() const;
  /// Standard deviation of an axis times the root of the period, in the second where it is least: an upper
  /// bound of the white noise [rad/s/sqrt(Hz), m/s^2/sqrt(Hz)] where the sensor does not filter. None while
  /// no second has 50 samples of which every axis varies.
  [[nodiscard]] const std::optional<double>& gyro_density() const { return gyro_density_; }
  [[nodiscard]] const std::optional<double>& accel_density() const { return accel_density_; }

 private:
  void Close();

  InitConfig init_;
  // Of the second at hand (Welford 1962).
  TimeNs first_ns_ = 0;
  double samples_ = 0;
  Vector6d mean_ = Vector6d::Zero();
  Vector6d square_ = Vector6d::Zero();  ///< sum of squared deviations

  std::size_t judged_ = 0;
  std::vector<double> forces_;
  std::optional<double> gyro_density_, accel_density_;
};

}  // namespace alidade
