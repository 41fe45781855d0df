#pragma once

#include <Eigen/Core>
#include <array>
#include <deque>
#include <optional>

#include "core/time.h"

namespace alidade {

/// A measurement of absolute position beside an estimate that it has corrected.
struct AbsoluteComparison {
  TimeNs stamp_ns = 0;
  int index = 0;                                                ///< which of the sensors of its kind
  Eigen::Vector3d change = Eigen::Vector3d::Zero();             ///< AbsoluteCorrection
  Eigen::Matrix3d change_covariance = Eigen::Matrix3d::Zero();  ///< AbsoluteCorrection
  /// Measured less estimated position of the antenna, after the correction [m], and the covariance of what
  /// was measured.
  Eigen::Vector3d left = Eigen::Vector3d::Zero();
  Eigen::Matrix3d left_covariance = Eigen::Matrix3d::Identity();
};

/// A contradiction between measured positions and vision with IMU.
struct Contradiction {
  double distance_m = 0;  ///< between the measured position and where they lead
  double sigmas = 0;
  double window_s = 0;  ///< they were followed for
};

/// Detects when measured positions are pulled away from where vision and IMU lead, as by a spoofer.
///
/// From any time on, the corrections that the measurements have made and what the last one leaves add up to
/// the distance between the measured position and the one that vision and IMU alone would have reached:
///
///   d = sum(change) + left,   V = sum(change covariance) + 2 R
///
/// The first part of V is what vision and IMU may drift by, as the estimate states it. R is the covariance of
/// one measured position; it is counted once for either end and not divided by their number, because errors
/// of multipath and atmosphere last. d^T V^-1 d is compared for windows of several lengths, and the distance
/// must last for several measurements: single wrong ones are a matter of gates.
///
/// Neglected: corrections of velocity, which move the estimate later. They make d smaller than it is.
class AbsoluteMonitor {
 public:
  /// Chosen on simulated multipath and real receivers (docs/faults.md).
  static constexpr double kMaxSigmas = 5;
  static constexpr int kLeastRun = 4;
  static constexpr double kLeastRunS = 2;
  static constexpr std::array<double, 4> kWindowsS = {8, 16, 32, 64};

  /// In order of time, those of one sensor.
  void Add(const AbsoluteComparison& comparison);
  /// The correction by another sensor, in order of time with the others: it moves the estimate as well.
  void AddCorrection(const AbsoluteComparison& of_another);
  /// As of the last comparison; nothing: none.
  [[nodiscard]] const std::optional<Contradiction>& contradiction() const { return contradiction_; }
  /// The largest statistic of the last comparison, whatever its run.
  [[nodiscard]] double sigmas() const { return sigmas_; }
  void Reset() { *this = AbsoluteMonitor(); }

 private:
  struct Run {
    TimeNs begin_ns = 0;
    int count = 0;
  };
  std::deque<AbsoluteComparison> history_;
  std::array<Run, kWindowsS.size()> runs_{};
  std::optional<Contradiction> contradiction_;
  double sigmas_ = 0;
};

}  // namespace alidade
