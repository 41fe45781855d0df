#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/camera_model.h"
#include "core/imu_sample.h"
#include "core/lie.h"
#include "core/position_fix.h"

namespace alidade {

/// The GNSS antenna on the rig and its receiver's time.
struct GnssReceiver {
  Eigen::Vector3d p_BA = Eigen::Vector3d::Zero();  ///< antenna in the body frame [m]
  double time_offset_s = 0;                        ///< t_imu = t_GPST + offset
  /// Origin of the ENU frame of the sequence's truth, ECEF [m], used for the estimates too. Empty: the first
  /// solution is the origin.
  std::optional<Eigen::Vector3d> anchor_E;
  bool is_present = false;  ///< the sequence has raw GNSS
};

/// What is known about the rig before a run; constant unless an estimator calibrates online.
struct RigCalibration {
  CameraModel camera;
  Pose T_BC;  ///< camera to body (IMU): p_B = T_BC * p_C
  ImuNoise imu_noise;
  double camera_time_offset_s = 0;  ///< t_imu = t_camera + offset
  /// Of a rolling shutter: row v is exposed at the stamp + line_delay_s (v - height / 2), in the middle of
  /// its exposure; 0: all rows at once.
  double line_delay_s = 0;
  GnssReceiver gnss = {};
  std::vector<FixSensor> fixes = {};
};

}  // namespace alidade
