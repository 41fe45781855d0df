#pragma once

#include <Eigen/Core>
#include <optional>

#include "core/gyro_rotation.h"
#include "core/rig_calibration.h"
#include "core/track_frame.h"
#include "eval/run/imu_stream.h"
#include "eval/run/turn_misfit.h"

namespace alidade {

/// Finds forward jumps of the IMU's clock, after which all stamps are late by the same time.
///
/// A silence of the IMU is either a loss of samples, after which the stamps are right, or a jump. Two frames
/// after the silence decide: the rig has turned between them by the gyroscope over their stamps as they are,
/// or over later ones, later by the length of the silence less the usual step. Both turns are measured, so
/// that a silence cannot be taken for a jump because the motion in it is not known. The tracks of both frames
/// decide (TurnMisfit, ClockVotes).
///
/// Neglected: jumps with a loss of samples at the same time. Without a turn whose rate changes, or without
/// enough common tracks for kDoubtS, the stamps stay as they are.
class ImuClock {
 public:
  static constexpr double kDoubtS = 1;  ///< after the silence

  /// `pixel_noise_px`: of an observation. `rig` must outlive the object.
  ImuClock(const RigCalibration& rig, double pixel_noise_px) : rig_(rig), pixel_noise_px_(pixel_noise_px) {}

  /// The silence in question.
  [[nodiscard]] const std::optional<ImuSilence>& silence() const { return silence_; }
  void Question(const ImuSilence& silence) {
    silence_ = silence;
    votes_ = {};
    compared_ns_ = INT64_MIN;
  }
  /// Ends the question. Silences that end by then are not to be questioned again.
  void Settle();
  [[nodiscard]] TimeNs settled_ns() const { return settled_ns_; }
  /// Camera stamp of the last frame that was compared.
  [[nodiscard]] TimeNs compared_ns() const { return compared_ns_; }

  /// A frame at `imu_ns`, by its stamp as it is; every one, in order, while a silence is in question. `gyro`:
  /// the samples after the silence, which reach imu_ns + ImuSilence::excess_ns. True: the clock has jumped by
  /// that.
  bool FindJump(const TrackFrame& frame, TimeNs imu_ns, const GyroRotation& gyro,
                const Eigen::Vector3d& gyro_bias);

 private:
  struct Seen {
    TrackFrame frame;
    TimeNs imu_ns = 0;
  };

  const RigCalibration& rig_;
  const double pixel_noise_px_;
  std::optional<ImuSilence> silence_;
  std::optional<Seen> first_;  ///< frame after it, of those with common tracks
  ClockVotes votes_;
  TimeNs settled_ns_ = INT64_MIN;
  TimeNs compared_ns_ = INT64_MIN;
};

}  // namespace alidade
