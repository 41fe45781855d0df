#pragma once

#include <Eigen/Core>
#include <span>

#include "core/navigation_state.h"
#include "core/visual_observation.h"

namespace alidade {

/// Which views give the depth: all of them, or the base and the last one only (two-view representation).
enum class DepthViews { kMulti, kTwo };

/// Depth of a landmark in its base view as a function of poses and observations alone (paper eq. 4-1, 4-2):
/// A_i = [z_i]x R_i^T R_b z_b, b_i = -[z_i]x R_i^T (p_b - p_i) over the other views i, d = A^T b / A^T A. z_i
/// is the direction that view i observed (NormalizedObservation::Ray), before the camera or not.
struct PoseOnlyDepth {
  double depth = 0;   ///< along the normal of the base observation's plane [m]: its z axis, or its ray
  double normal = 0;  ///< A^T A: parallax information; sigma / sqrt(A^T A) is the depth's relative deviation
  Eigen::Vector3d p_W = Eigen::Vector3d::Zero();  ///< p_b + d R_b z_b
};

/// d p_W of a PoseOnlyDepth, total derivatives: 3 x 6N over (phi, dp) of the views and 3 x 2N over their z.
/// The estimators' rows do not need them: what they add vanishes with the landmark (docs/pose_only.md).
struct PoseOnlyJacobians {
  Eigen::Matrix<double, 3, Eigen::Dynamic> poses;
  Eigen::Matrix<double, 3, Eigen::Dynamic> observations;
};

/// False when the views have no parallax (A^T A is zero to rounding) or a number is not finite. The depth may
/// be negative: the caller checks. Needs at least two views; base in range. jacobians: null skips them.
bool ComputePoseOnlyDepth(std::span<const Pose> T_WC, std::span<const NormalizedObservation> observations,
                          int base, DepthViews views, PoseOnlyDepth* depth,
                          PoseOnlyJacobians* jacobians = nullptr);

/// Parallax gate: true when the depth's relative deviation sigma / sqrt(A^T A) is below
/// `max_relative_deviation`. Noise alone makes A^T A about 4 sigma^2 for each of the `other_views`, which is
/// subtracted first: otherwise a long track at rest would pass. `sigma`: standard deviation on the normalised
/// plane.
[[nodiscard]] bool DepthIsDetermined(const PoseOnlyDepth& depth, int other_views, double sigma,
                                     double max_relative_deviation);

}  // namespace alidade
