#pragma once

#include <optional>
#include <string>

#include "core/imu_sample.h"

namespace alidade {

/// Replaces single inertial samples that cannot be motion: a spike of the sensor or of the transmission.
///
/// A sample is one when it differs from both neighbours by more than the limit and the neighbours differ from
/// each other by less than half of that; it is replaced by the mean of the neighbours. The limit is ten times
/// the root mean square of the recent steps from sample to sample (time constant 100 samples), at least 0.5
/// rad/s and 5 m/s^2. A sample whose successor is not to be waited for is one when its step is 25 times that,
/// at least 5 rad/s and 50 m/s^2; it is replaced by the sample before it, unless that was replaced likewise:
/// a step that lasts is motion. Samples more than 50 ms from a neighbour are not judged.
class ImuGuard {
 public:
  /// Judges the next sample in order and mends it. `next`: the one after it, null when it is not to be waited
  /// for. Returns what was wrong, or nothing.
  std::string Mend(const ImuSample* next, ImuSample* sample);

 private:
  /// Of gyroscope or accelerometer.
  struct Signal {
    double floor;  ///< of the limit
    double mean_square = 0;
    bool held = false;  ///< the last sample was replaced by the one before it
  };
  [[nodiscard]] bool IsSpike(const Signal& signal, const Eigen::Vector3d& before, const Eigen::Vector3d& here,
                             const Eigen::Vector3d* after) const;
  void MendSignal(const Eigen::Vector3d& before, const Eigen::Vector3d* after, const char* name,
                  const char* unit, Eigen::Vector3d* here, Signal* signal, std::string* fault);

  std::optional<ImuSample> last_;  ///< as mended
  int judged_ = 0;
  Signal gyro_{.floor = 0.5};
  Signal accel_{.floor = 5};
};

}  // namespace alidade
