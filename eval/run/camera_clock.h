#pragma once

#include <Eigen/Core>
#include <deque>
#include <optional>

#include "core/gyro_rotation.h"
#include "core/rig_calibration.h"
#include "core/track_frame.h"

namespace alidade {

/// Finds jumps of the camera's clock, after which all stamps are off by the same time.
///
/// A step of the stamps that is much longer than those before is either a silence of the camera or a jump.
/// Both give how far the rig has turned between the frame before the step and a frame after it: the gyroscope
/// over the stamps as they are, or over the usual step. The tracks of both frames decide (TurnMisfit).
/// Without enough common tracks, or a turn that decides, the stamps stay as they are.
///
/// Neglected: clocks that step back (such frames are late and refused), and jumps of less than kLeastStepS.
class CameraClock {
 public:
  static constexpr double kLeastStepS = 0.25;  ///< and kLeastPeriods periods
  static constexpr double kLeastPeriods = 4;
  static constexpr double kMostStepS = 10;  ///< for so long the gyroscope is remembered
  static constexpr double kDoubtS = 2;      ///< after the step

  /// `pixel_noise_px`: of an observation. `rig` must outlive the object.
  CameraClock(const RigCalibration& rig, double pixel_noise_px)
      : rig_(rig), pixel_noise_px_(pixel_noise_px) {}

  /// Every sample that comes; one out of order is ignored.
  void AddImu(const ImuSample& sample);
  /// The stamps of the samples from `from_ns` on were moved back by `by_ns`.
  void TakeBackImu(TimeNs from_ns, TimeNs by_ns) { gyro_.TakeBack(from_ns, by_ns); }
  /// A frame that the IMU reaches at `imu_ns`, the time of its stamp; every one, in order. By how much the
  /// stamps have jumped [ns], if this frame decides; it and later frames lie that much earlier.
  std::optional<TimeNs> FindJump(const TrackFrame& frame, TimeNs imu_ns, const Eigen::Vector3d& gyro_bias);

 private:
  struct Seen {
    TrackFrame frame;
    TimeNs imu_ns = 0;
  };
  struct Step {
    Seen before;
    TimeNs excess_ns = 0;  ///< the jump, if it is one
    TimeNs end_ns = 0;     ///< of doubt
  };

  /// Of the usual steps.
  [[nodiscard]] std::optional<TimeNs> Period() const;

  const RigCalibration& rig_;
  const double pixel_noise_px_;
  GyroRotation gyro_;
  std::deque<TimeNs> steps_;
  std::optional<Seen> last_;
  std::optional<Step> step_;  ///< in doubt
};

}  // namespace alidade
