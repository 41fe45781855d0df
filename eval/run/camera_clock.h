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
/// over the stamps as they are, or over the usual step. The tracks of both frames
/// decide, by their distance to the epipolar plane of the best direction of translation (Kneip and Lynen
/// 2013; frontend/initialization/epipolar_ray.h). Without enough common tracks, or a turn that decides, the
/// stamps stay as they are.
///
/// Neglected: clocks that step back (such frames are late and refused), and jumps of less than kLeastStepS.
class CameraClock {
 public:
  static constexpr double kLeastStepS = 0.25;  ///< and kLeastPeriods periods
  static constexpr double kLeastPeriods = 4;
  static constexpr double kMostStepS = 10;  ///< for so long the gyroscope is remembered
  static constexpr double kDoubtS = 2;      ///< after the step
  static constexpr int kLeastTracks = 12;
  /// Largest squared distance, in its variance, of an explanation that holds, and how much larger that of the
  /// other must be.
  static constexpr double kFits = 4;
  static constexpr double kContrast = 10;

  /// `pixel_noise_px`: of an observation. `rig` must outlive the object.
  CameraClock(const RigCalibration& rig, double pixel_noise_px)
      : rig_(rig), pixel_noise_px_(pixel_noise_px) {}

  /// Every sample that comes; one out of order is ignored.
  void AddImu(const ImuSample& sample);
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
  /// Median squared distance of the common tracks to the epipolar plane, in its variance, when the body
  /// turned by R_ab between the frames; nothing with too few tracks.
  [[nodiscard]] std::optional<double> Misfit(const TrackFrame& a, const TrackFrame& b,
                                             const Eigen::Matrix3d& R_ab) const;

  const RigCalibration& rig_;
  const double pixel_noise_px_;
  GyroRotation gyro_;
  std::deque<TimeNs> steps_;
  std::optional<Seen> last_;
  std::optional<Step> step_;  ///< in doubt
};

}  // namespace alidade
