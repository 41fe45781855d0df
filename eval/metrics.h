#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "eval/trajectory.h"

namespace alidade {

enum class Alignment { kNone, kPos, kPosYaw, kSe3, kSim3 };
[[nodiscard]] std::optional<Alignment> ParseAlignment(std::string_view name);  // none|pos|posyaw|se3|sim3
[[nodiscard]] std::string_view ToString(Alignment alignment);

/// Truth interpolated or picked at each estimate stamp.
struct StatePair {
  TrajectoryPoint truth;
  TrajectoryPoint estimate;
};

/// Pairs within max_dt_s, nearest first, one to one. Interpolates truth (linear, slerp) between rows at most
/// max_gap_s apart when `interpolate`; never over gaps. Error (kInput) when fewer than 3 match: names both time ranges,
/// the match count and a hint (seconds against nanoseconds, a constant offset, max_dt too small).
struct AssociationOptions {
  double max_dt_s = 0.01;
  bool interpolate = false;
  double max_gap_s = 0.1;
};
Result<std::vector<StatePair>> Associate(const Trajectory& truth, const Trajectory& estimate,
                                         const AssociationOptions& options);

/// p_truth ~ scale R p_estimate + t.
struct AlignmentTransform {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();
  double scale = 1;
};
[[nodiscard]] AlignmentTransform Align(const std::vector<StatePair>& pairs, Alignment alignment);
[[nodiscard]] std::vector<StatePair> ApplyAlignment(const std::vector<StatePair>& pairs,
                                                    const AlignmentTransform& transform);

struct AteResult {
  double pos_m = 0;   ///< rmse
  double ori_deg = 0; ///< rmse of the rotation angle
  double pos_max_m = 0;
};
[[nodiscard]] AteResult ComputeAte(const std::vector<StatePair>& aligned_pairs);

struct RpeResult {
  double distance_m = 0;
  int count = 0;
  double pos_rmse_m = 0;
  double ori_rmse_deg = 0;
  std::vector<double> pos_errors_m;  ///< for box plots
};
/// Relative error over sub-trajectories of the given truth path length, in the frame of their first pose.
[[nodiscard]] std::vector<RpeResult> ComputeRpe(const std::vector<StatePair>& pairs,
                                                const std::vector<double>& distances_m);

/// NEES of (phi, dp) in the canonical chart: phi = Log(R_est^T R_truth), dp = p_truth - p_est. Unaligned.
struct NeesResult {
  std::vector<double> pose, orientation, position;  ///< one a pair; NaN where the covariance is singular
  double mean_pose = 0, mean_orientation = 0, mean_position = 0;
  double coverage_3sigma = 0;  ///< share of the six error components inside +-3 sigma
};
[[nodiscard]] NeesResult ComputeNees(const std::vector<StatePair>& pairs);

/// Two-sided chi-square band of the mean of `samples` independent NEES values with `dof` degrees of freedom.
[[nodiscard]] std::pair<double, double> NeesBand(int dof, double samples, double probability = 0.95);

/// Path length of the truth rows between the first and last pair [m].
[[nodiscard]] double PathLength(const std::vector<StatePair>& pairs);

}  // namespace alidade
