#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/camera_model.h"
#include "core/imu_sample.h"
#include "core/navigation_state.h"
#include "core/position_fix.h"

namespace alidade {

/// One tracked feature in one frame. Ids are unique in a log: a track that ends never comes back under its
/// id.
struct TrackObservation {
  std::int64_t track_id = 0;
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();  ///< raw (distorted) image coordinates [px]
};

/// All observations of one camera image, sorted by track id.
struct TrackFrame {
  TimeNs stamp_ns = 0;
  std::vector<TrackObservation> observations;
  /// Wall time the front end spent on this frame; 0 when the tracks were read from a file.
  double frontend_ms = 0;
};

/// The GNSS antenna on the rig and its receiver's time.
struct GnssReceiver {
  Eigen::Vector3d p_BA = Eigen::Vector3d::Zero();  ///< antenna in the body frame [m]
  double time_offset_s = 0;                        ///< t_imu = t_GPST + offset
  /// Origin of the ENU frame of the sequence's truth, ECEF [m], used for the estimates too. Empty: the first
  /// solution is the origin.
  std::optional<Eigen::Vector3d> anchor_E;
};

struct GnssLog;  // gnss/model/gnss_epoch.h

/// What is known about the rig before a run; constant unless an estimator calibrates online.
struct RigCalibration {
  CameraModel camera;
  Pose T_BC;  ///< camera to body (IMU): p_B = T_BC * p_C
  ImuNoise imu_noise;
  double camera_time_offset_s = 0;  ///< t_imu = t_camera + offset
  GnssReceiver gnss = {};
  std::vector<FixSensor> fixes = {};
};

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
};

}  // namespace alidade
