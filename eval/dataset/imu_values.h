#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <string>

#include "core/imu_sample.h"
#include "core/lie.h"

namespace alidade {

class Findings;

/// Whether columns hold what they should, in SI units.
struct SoundColumns {
  bool rate = true;
  bool force = true;
};

/// Statistics over all samples of an IMU, for its units and axes.
class ImuValues {
 public:
  void Add(const ImuSample& sample);

  /// Errors of units, of exchanged groups of columns and of dead axes, and repeated rows. Columns with an
  /// error are not sound. Precondition: two samples.
  SoundColumns Check(Findings* findings) const;
  /// Mean norm of the specific force [m/s^2].
  [[nodiscard]] double MeanForce() const { return force_ / Count(); }

 private:
  [[nodiscard]] double Count() const { return static_cast<double>(count_); }
  [[nodiscard]] bool GroupsSeemExchanged() const;
  /// "accelerometer z is 0": of the axes [first, last) that never change; empty without one.
  [[nodiscard]] std::string DeadAxes(int first, int last) const;
  /// False: an error was reported.
  bool CheckForce(Findings* findings) const;
  bool CheckRate(Findings* findings) const;
  void CheckRepeated(Findings* findings) const;

  std::size_t count_ = 0;
  std::size_t repeated_ = 0;
  Vector6d last_ = Vector6d::Zero();
  Vector6d low_ = Vector6d::Constant(INFINITY), high_ = Vector6d::Constant(-INFINITY);
  double force_ = 0;  ///< sum of the norms of the specific force
  double rate_ = 0;   ///< sum of the norms of the angular rate
  double rate_square_ = 0;
  double fastest_ = 0;
};

}  // namespace alidade
