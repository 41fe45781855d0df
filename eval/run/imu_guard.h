#pragma once

#include <optional>
#include <string>

#include "core/imu_sample.h"
#include "eval/run/imu_axis_watch.h"

namespace alidade {

/// Finds inertial samples that cannot be motion: spikes, which it replaces, a gyroscope that changes its
/// unit, which it converts, and axes that do not measure, which it gives a noise (ImuAxisWatch).
///
/// A sample is a spike when it differs from both neighbours by more than the limit and the neighbours differ
/// from each other by less than half of that; it is replaced by the mean of the neighbours. The limit is ten
/// times the root mean square of the recent steps from sample to sample (time constant 100 samples), at least
/// 0.5 rad/s and 5 m/s^2. A sample whose successor is not to be waited for is one when its step is 25 times
/// that, at least 5 rad/s and 50 m/s^2; it is replaced by the sample before it, unless that was replaced
/// likewise: a step that lasts is motion. Samples more than 50 ms from a neighbour are not checked.
///
/// The gyroscope has changed to deg/s when a rate that is known well, at least ten times that root mean
/// square, is followed by one that jumps by at least 5 rad/s and lies, divided by 180 / pi, within four times
/// the root mean square of it, as does the next sample where there is one. No motion multiplies all three
/// rates by the same 57 within a sample. It has changed back when the opposite holds. A change at rest is
/// not found: nothing reveals its unit.
class ImuGuard {
 public:
  /// implied: what the motion implies, for axes that do not measure; null: nothing is known. Must outlive the
  /// object.
  explicit ImuGuard(const ImpliedImu* implied = nullptr) : axes_(implied) {}

  /// Checks the next sample in order and mends it. `next`: the one after it, null when it is not to be waited
  /// for. Returns what was wrong, or nothing.
  std::string Mend(const ImuSample* next, ImuSample* sample);
  /// What is wrong with the last sample and was not mended; empty: nothing.
  [[nodiscard]] const std::string& doubt() const { return axes_.reason(); }
  /// A rate in the unit that the gyroscope has now, in rad/s.
  [[nodiscard]] Eigen::Vector3d InRadians(const Eigen::Vector3d& gyro) const { return gyro / unit_; }
  /// When the unit changed last.
  [[nodiscard]] std::optional<TimeNs> unit_changed_ns() const { return unit_changed_ns_; }

 private:
  /// Of gyroscope or accelerometer.
  struct Signal {
    double floor;  ///< of the limit
    double mean_square = 0;
    bool held = false;  ///< the last sample was replaced by the one before it
  };
  /// Converts the sample, after a change of the unit that it may show. `next`: as it came.
  std::string MendUnit(const ImuSample* next, ImuSample* sample);
  [[nodiscard]] bool IsSpike(const Signal& signal, const Eigen::Vector3d& before, const Eigen::Vector3d& here,
                             const Eigen::Vector3d* after) const;
  void MendSignal(const Eigen::Vector3d& before, const Eigen::Vector3d* after, const char* name,
                  const char* unit, Eigen::Vector3d* here, Signal* signal, std::string* fault);

  std::optional<ImuSample> last_;  ///< as mended
  int judged_ = 0;
  Signal gyro_{.floor = 0.5};
  Signal accel_{.floor = 5};
  double unit_ = 1;  ///< of the gyroscope: 1, or 180 / pi where it is in deg/s
  std::optional<TimeNs> unit_changed_ns_;
  ImuAxisWatch axes_;
};

}  // namespace alidade
