#pragma once

#include <memory>
#include <vector>

#include "core/estimator/measurement.h"
#include "core/rig_calibration.h"
#include "core/track_frame.h"
#include "gnss/model/gnss_epoch.h"

namespace alidade {

/// One more camera of the rig beside the one in RigCalibration. Its track ids are those of the first camera
/// where both see the same landmark.
struct ExtraCamera {
  CameraModel camera;
  Pose T_BC;
  double camera_time_offset_s = 0;  ///< t_imu = t_camera + offset
  std::vector<TrackFrame> frames;   ///< strictly increasing stamps
};

/// The one input every estimator of a comparison reads: IMU and tracks, time-ordered, with the rig's
/// calibration.
struct MeasurementLog {
  RigCalibration rig;
  std::vector<ImuSample> imu;      ///< strictly increasing stamps
  std::vector<TrackFrame> frames;  ///< strictly increasing stamps
  /// Recorded, and part of the digest; the estimators read the first camera alone.
  std::vector<ExtraCamera> extra_cameras = {};
  /// Raw observations and ephemerides; null without GNSS.
  std::shared_ptr<const GnssLog> gnss = nullptr;
  /// Of all sensors, in the order of IMU time (stamp + the sensor's offset); those of one sensor with
  /// strictly increasing stamps.
  std::vector<PositionFix> fixes = {};
  int imu_rejected = 0;  ///< samples that the reader dropped
};

/// Copies the measurements of SensorEntries. `From`, `To`: MeasurementLog, or what has its fields.
template <typename From, typename To>
void CopyMeasurements(const From& from, To* to) {
  ForEachSensorEntry([&](auto entry, Sensor) { entry.Measurements(*to) = entry.Measurements(from); });
}

}  // namespace alidade
