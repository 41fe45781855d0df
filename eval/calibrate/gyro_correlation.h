#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "core/rig_calibration.h"
#include "eval/dataset/log_tables.h"

namespace alidade {

/// The camera's mean angular rate between two frames, from their tracks alone.
struct ImageTurn {
  TimeNs i_ns = 0, j_ns = 0;                         ///< of the frames, camera's clock
  Eigen::Vector3d rate_C = Eigen::Vector3d::Zero();  ///< in the camera's axes [rad/s]
};

/// Turns of frames about 0.1 s apart over the two minutes from the first notable motion on. Of rays f_i and
/// f_j, unit length, the rotation vector phi minimises the robust sum of |f_i - f_j - phi x (f_i + f_j) / 2|.
/// Neglected: the translation, which changes the rates by up to a fifth and spreads over the axes, lens
/// errors, a rolling shutter. Frames further apart than 0.35 s give none.
[[nodiscard]] std::vector<ImageTurn> TurnsOfImages(const CameraModel& camera,
                                                   const Table<TrackFrame>& frames);

/// Norms of angular rate, of images and gyroscope, when the camera's stamps are moved by a lag.
struct LaggedRates {
  double lag_s = 0;
  double correlation = 0;
  double scale = 0;   ///< the gyroscope's root mean square over the images'
  double span_s = 0;  ///< that the turns cover together
  std::size_t turns = 0;

  /// The share of the variance that they do not have in common; at least what translation and noise of the
  /// tracks leave in good recordings.
  [[nodiscard]] double unexplained() const {
    constexpr double kLeast = 0.01;
    return std::max(kLeast, 1 - (correlation > 0 ? correlation * correlation : 0));
  }
};

/// How images and gyroscope agree over lags within ten seconds. Norms do not depend on T_BS.
struct GyroCorrelation {
  static constexpr double kReachS = 10;
  static constexpr double kNearS = 0.3;  ///< what FindCameraGyro searches by itself

  LaggedRates best;
  LaggedRates near;   ///< best within kNearS of zero; no turns: the sensors share too little time there
  LaggedRates other;  ///< best peak more than half a second from `best`; no turns: there is none

  /// Whether they agree at all. 0.8: turns of recordings in order reach 0.94 to 0.99.
  [[nodiscard]] bool agree() const { return best.correlation >= 0.8; }
  /// Whether the agreement is of another lag than about zero and of no second one, as with periodic motion:
  /// variances of some fifty independent turns differ by a factor of two by chance once in a hundred times.
  [[nodiscard]] bool clocks_differ() const {
    return agree() && near.turns > 0 && other.turns > 0 && std::abs(best.lag_s) > kNearS &&
           near.unexplained() > 4 * best.unexplained() && other.unexplained() > 2 * best.unexplained();
  }
  /// Whether clocks_differ is certain. Smooth motion of a shorter time has few independent turns: in
  /// synthetic recordings of 15 to 30 s of it, up to 2 % of those in order have a distinct lag, and none of
  /// longer ones.
  [[nodiscard]] bool certain() const { return best.span_s >= 30; }
};

/// Correlates turns with the gyroscope. time_offset_s: of the sheet, where the lag is zero. Lags at which
/// less than half the turns, or less than fifteen seconds of them (five within kNearS, which claim nothing),
/// lie within the IMU's samples are left out.
[[nodiscard]] GyroCorrelation CorrelateGyro(const std::vector<ImageTurn>& turns, const Table<ImuSample>& imu,
                                            double time_offset_s);

/// The text for clocks_differ, with the time offset to enter instead of the sheet's, or by how much to shift
/// the stamps where a sheet takes no such offset (kMostCameraOffsetS).
[[nodiscard]] std::string DescribeClocks(const GyroCorrelation& rates, double sheet_time_offset_s);

}  // namespace alidade
