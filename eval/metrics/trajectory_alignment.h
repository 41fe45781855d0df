#pragma once

#include <Eigen/Core>
#include <optional>
#include <string_view>
#include <vector>

#include "eval/metrics/state_pair.h"

namespace alidade {

enum class TrajectoryAlignment { kNone, kPos, kPosYaw, kSe3, kSim3 };
[[nodiscard]] std::optional<TrajectoryAlignment> ParseTrajectoryAlignment(
    std::string_view name);  // none|pos|posyaw|se3|sim3
[[nodiscard]] std::string_view ToString(TrajectoryAlignment alignment);

/// World of the estimate to world of the truth: p_truth ~ scale R p_estimate + t, R_truth ~ R R_estimate.
struct AlignmentTransform {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();
  double scale = 1;
};
/// Least squares over the positions of all pairs: none (identity), pos (mean offset), posyaw (yaw about z and
/// offset: the unobservable directions of visual-inertial odometry), se3 and sim3 (Umeyama 1991). A
/// degenerate cloud (one point, a line) gives one of its minimisers, always finite.
[[nodiscard]] AlignmentTransform Align(const std::vector<StatePair>& pairs, TrajectoryAlignment alignment);
/// Yaw about z and offset that move the first estimate to the truth, except for its tilt: for an estimate
/// with an arbitrary yaw and origin. Needs at least one pair.
[[nodiscard]] AlignmentTransform AnchorAtFirst(const std::vector<StatePair>& pairs);
/// The pairs with their estimates moved to the truth's world: position, rotation, velocity and covariance.
[[nodiscard]] std::vector<StatePair> ApplyAlignment(const std::vector<StatePair>& pairs,
                                                    const AlignmentTransform& transform);

}  // namespace alidade
