#pragma once

#include <Eigen/Core>

#include "core/config_schema.h"
#include "core/status.h"

namespace alidade {

/// The position sensor of a simulation. Its frame is the world, the ENU frame at the anchor of SimGnssConfig,
/// or a frame of its own.
struct SimFixConfig {
  double rate_hz = 0;  ///< 0: no sensor
  double std_m = 1;    ///< east and north; also in the written covariance
  double up_factor = 1.5;
  Eigen::Vector3d lever_arm_m = Eigen::Vector3d(-0.1, 0.05, 0.12);  ///< p_BA
  double time_offset_s = 0;                                         ///< t_imu = t_fix + offset
  bool own_frame = false;
  double frame_yaw_rad = 0;
  Eigen::Vector3d frame_shift_m = Eigen::Vector3d::Zero();
  double wrong_rate = 0;
  double wrong_min_m = 10;
  double wrong_max_m = 50;
  double outage_start_s = -1;
  double outage_s = 30;

  void Describe(ConfigVisitor& visitor);
  [[nodiscard]] Status Validate() const;
};

}  // namespace alidade
