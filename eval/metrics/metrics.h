#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "eval/trajectory/trajectory.h"

namespace alidade {

enum class Alignment { kNone, kPos, kPosYaw, kSe3, kSim3 };
[[nodiscard]] std::optional<Alignment> ParseAlignment(std::string_view name);  // none|pos|posyaw|se3|sim3
[[nodiscard]] std::string_view ToString(Alignment alignment);

/// A truth row (or truth interpolated to the estimate's stamp) and the estimate row compared with it.
struct StatePair {
  TrajectoryPoint truth;
  TrajectoryPoint estimate;
};

/// How truth and estimate rows become pairs. Nearest: pairs within max_dt_s (stamps that differ by exactly
/// that are compared as doubles of seconds, as evo and the rpg tools do), nearest first, one to one, never
/// crossing in time. Interpolated: truth at each estimate stamp (position, velocity, biases linear, rotation
/// geodesic) between rows at most max_gap_s apart, never over longer gaps nor past the ends; max_dt_s is not
/// used.
struct AssociationOptions {
  double max_dt_s = 0.01;
  bool interpolate = false;
  double max_gap_s = 0.1;
};
/// Pairs in time order. Errors: fewer than 3 pairs are kInput, with both time ranges [s], the match count and
/// a hint (wrong time unit, a constant offset, the tolerance that would match); a tolerance that is negative,
/// not finite or above 1e9 s is kUsage.
Result<std::vector<StatePair>> Associate(const Trajectory& truth, const Trajectory& estimate,
                                         const AssociationOptions& options);

/// World of the estimate to world of the truth: p_truth ~ scale R p_estimate + t, R_truth ~ R R_estimate.
struct AlignmentTransform {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();
  double scale = 1;
};
/// Least squares over the positions of all pairs: none (identity), pos (mean offset), posyaw (yaw about z and
/// offset: the unobservable directions of visual-inertial odometry), se3 and sim3 (Umeyama 1991). A
/// degenerate cloud (one point, a line) gives one of its minimisers, always finite.
[[nodiscard]] AlignmentTransform Align(const std::vector<StatePair>& pairs, Alignment alignment);
/// Yaw about z and offset that move the first estimate to the truth, except for its tilt: for an estimate
/// with an arbitrary yaw and origin. Needs at least one pair.
[[nodiscard]] AlignmentTransform AnchorAtFirst(const std::vector<StatePair>& pairs);
/// The pairs with their estimates moved to the truth's world: position, rotation, velocity and covariance.
[[nodiscard]] std::vector<StatePair> ApplyAlignment(const std::vector<StatePair>& pairs,
                                                    const AlignmentTransform& transform);

/// Absolute trajectory error; NaN when there are no pairs.
struct AteResult {
  double pos_m = 0;    ///< rmse
  double ori_deg = 0;  ///< rmse of the rotation angle
  double pos_max_m = 0;
};
[[nodiscard]] AteResult ComputeAte(const std::vector<StatePair>& aligned_pairs);

struct RpeResult {
  double distance_m = 0;
  int count = 0;          ///< sub-trajectories; 0 when the path is too short or the distance not positive
  double pos_rmse_m = 0;  ///< NaN when count is 0
  double ori_rmse_deg = 0;
  std::vector<double> pos_errors_m;  ///< for box plots
};
/// Relative error over sub-trajectories of the given truth path length [m], in the frame of their first pose
/// (Geiger et al. 2012, Zhang and Scaramuzza 2018): T_truth = T_first^-1 T_last against the estimate's. Every
/// pair starts one that ends at the pair nearest to the distance, if that is within 10 % of it.
[[nodiscard]] std::vector<RpeResult> ComputeRpe(const std::vector<StatePair>& pairs,
                                                const std::vector<double>& distances_m);

/// NEES of (phi, dp) in the canonical chart: phi = Log(R_est^T R_truth), dp = p_truth - p_est. Unaligned.
struct NeesResult {
  std::vector<double> pose, orientation, position;  ///< one a pair; NaN where the covariance is singular
  /// Means over the regular covariances; NaN when there is none.
  double mean_pose = 0, mean_orientation = 0, mean_position = 0;
  double coverage_3sigma = 0;  ///< share of the six error components inside +-3 sigma; NaN likewise
};
[[nodiscard]] NeesResult ComputeNees(const std::vector<StatePair>& pairs);

/// Two-sided chi-square band of the mean of `samples` independent NEES values with `dof` degrees of freedom.
/// Successive frames are correlated: count runs, not frames. NaN for invalid arguments.
[[nodiscard]] std::pair<double, double> NeesBand(int dof, double samples, double probability = 0.95);

/// Path length of the truth through the pairs, first to last [m].
[[nodiscard]] double PathLength(const std::vector<StatePair>& pairs);

}  // namespace alidade
