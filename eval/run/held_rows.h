#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "core/time.h"

namespace alidade {

/// Rows of a log in a row in which no axis of a sensor changes. Drivers hand out a measurement again when the
/// other sensor is faster, so a few of them are no fault.
class HeldRows {
 public:
  static constexpr std::int64_t kFrozen = 20;
  static constexpr double kFrozenS = 0.1;

  /// The first row, or one in which the sensor changes; other: what the other sensor measures.
  void Restart(TimeNs stamp_ns, const Eigen::Vector3d& other);
  /// A row in which it does not.
  void Add(const Eigen::Vector3d& other);
  /// Decides on the rows so far; false: they are no fault whatever their number.
  void Judge(bool may_be_fault, TimeNs stamp_ns);

  [[nodiscard]] std::int64_t rows() const { return rows_; }
  /// Largest change of an axis of the other sensor meanwhile.
  [[nodiscard]] double OtherSpan() const { return (high_ - low_).maxCoeff(); }
  /// Since kFrozen rows in a row, three times as many as ever before, which last kFrozenS.
  [[nodiscard]] bool frozen() const { return frozen_; }

 private:
  bool frozen_ = false;
  std::int64_t rows_ = 0;
  std::int64_t longest_ = 0;  ///< of the times before, without those that were frozen
  TimeNs since_ns_ = 0;
  Eigen::Vector3d low_ = Eigen::Vector3d::Zero();  ///< of the other sensor
  Eigen::Vector3d high_ = Eigen::Vector3d::Zero();
};

}  // namespace alidade
