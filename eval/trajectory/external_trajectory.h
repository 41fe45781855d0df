#pragma once

#include <optional>
#include <string>
#include <vector>

#include "eval/trajectory/trajectory.h"

namespace alidade {

/// Information that files of other programs do not contain.
struct ExternalContext {
  /// Origin of the ENU frame for files of geodetic positions. Empty: the first row becomes the origin and is
  /// stored here.
  std::optional<Eigen::Vector3d> anchor_E;
  double gnss_time_offset_s = 0;      ///< t_imu = t_GPST + offset, for files of geodetic positions
  std::vector<TimeNs> camera_stamps;  ///< of the sequence, in IMU time, for files without stamps
  std::optional<Pose> T_BC;           ///< set: the file holds camera poses, which are converted to body poses
};

/// Reads a trajectory file of another program. The format is recognised by its name and first rows:
///
///   what ReadTrajectory reads            EuRoC, TUM and alidade files
///   RTKLIB .pos                          GPST or UTC; calendar or week; degrees or ECEF; no orientation
///   KITTI: 12 numbers a row              row-major [R p]; one row a camera stamp
///   OpenVINS "# timestamp(s) q"          state_estimate: stamp, JPL quaternion global to IMU (the same
///                                        numbers as Hamilton's IMU to global), position, velocity, ...
///   OpenVINS "# timestamp(s) tx"         traj_estimate: TUM columns, covariances behind them
///   VINS-Mono: commas, no header         stamp [ns or s], p, q with w first, velocity
///
/// Errors (kInput): file and line, as ReadTrajectory; KITTI rows that are not one a stamp.
Result<Trajectory> ReadExternalTrajectory(const std::string& path, ExternalContext* context);

}  // namespace alidade
