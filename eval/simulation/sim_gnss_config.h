#pragma once

#include <Eigen/Core>
#include <string>

#include "core/config_schema.h"
#include "core/status.h"

namespace alidade {

/// The GNSS receiver of a simulation. The world is the ENU frame at the anchor.
struct SimGnssConfig {
  double rate_hz = 0;  ///< 0: no receiver
  double anchor_latitude_deg = 47.4;
  double anchor_longitude_deg = 8.5;
  double anchor_height_m = 450;
  Eigen::Vector3d lever_arm_m = Eigen::Vector3d(-0.1, 0.05, 0.12);  ///< p_BA
  double time_offset_s = 0;                                         ///< t_imu = t_GPST + offset
  std::string navigation_file = "none";                             ///< none: the embedded constellations
  std::string systems = "GECR";
  double elevation_mask_deg = 10;
  bool second_band = false;
  // Noise.
  double pseudorange_noise_m = 0.5;
  double range_rate_noise_mps = 0.05;
  // Delays.
  bool ionosphere = true;
  bool troposphere = true;
  double ionosphere_error = 0;
  // Clock.
  double clock_bias_m = 3000;
  double clock_drift_mps = 30;
  double clock_walk_m_sqrts = 0.03;
  double drift_walk_mps_sqrts = 0.03;
  double inter_system_bias_m = 5;
  double clock_jump_at_s = -1;
  // Environment.
  double multipath_m = 0;
  double multipath_time_s = 20;
  double nlos_rate = 0;
  double nlos_min_m = 10;
  double nlos_max_m = 80;
  double nlos_time_s = 20;
  double outage_start_s = -1;
  double outage_s = 30;
  int outage_satellites = 0;

  void Describe(ConfigVisitor& visitor);
  [[nodiscard]] Status Validate() const;
};

}  // namespace alidade
