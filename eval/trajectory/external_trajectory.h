#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/measurement_log.h"
#include "eval/trajectory/trajectory.h"

namespace alidade {

/// What a file of another program leaves unsaid.
struct ExternalContext {
  /// Origin of the ENU frame for files of geodetic positions; without it the first row is, and is put here.
  std::optional<Eigen::Vector3d> anchor_E;
  double gnss_time_offset_s = 0;      ///< t_imu = t_GPST + offset, for the same
  std::vector<TimeNs> camera_stamps;  ///< of the sequence, for files without stamps
  std::optional<Pose> T_BC;           ///< set: the file holds the camera's poses, which become the body's
};

/// Reads a trajectory as other programs write it, told by its name and first rows:
///
///   what ReadTrajectory reads                    EuRoC and TUM files, and ours
///   RTKLIB .pos                                  GPST or UTC; calendar or week; degrees or ECEF. No
///   orientation KITTI: 12 numbers a row                      row-major [R p]; one row a camera stamp
///   OpenVINS state_estimate: "# timestamp(s) q"  stamp, JPL quaternion global to IMU (the same numbers as
///   Hamilton's
///                                                IMU to global), position, velocity, ...
///   OpenVINS traj_estimate: "# timestamp(s) tx"  TUM columns, covariances behind them
///   VINS-Mono result: commas, no header          stamp [ns or s], p, q w first, velocity
///
/// Errors (kInput): file and line, as ReadTrajectory; KITTI rows that are not one a stamp.
Result<Trajectory> ReadExternalTrajectory(const std::string& path, ExternalContext* context);

}  // namespace alidade
