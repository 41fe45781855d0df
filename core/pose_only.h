#pragma once

#include <Eigen/Core>
#include <span>

#include "core/navigation_state.h"
#include "core/visual_observation.h"

namespace alidade {

/// Which views give the depth: all of them, or the base and the last one only (two-view representation).
enum class DepthViews { kMulti, kTwo };

/// Depth of a landmark in its base view as a function of poses and observations alone (paper eq. 4-1, 4-2):
/// A_i = [z_i]x R_i^T R_b z_b, b_i = -[z_i]x R_i^T (p_b - p_i) over the other views i, d = A^T b / A^T A.
struct PoseOnlyDepth {
  double depth = 0;   ///< along the base view's z axis [m]
  double normal = 0;  ///< A^T A: parallax information; sigma / sqrt(A^T A) is the depth's relative deviation
  Eigen::Vector3d p_W = Eigen::Vector3d::Zero();  ///< p_b + d R_b z_b
};

/// False when the views have no parallax (A^T A is zero to rounding) or a number is not finite. The depth may
/// be negative: the caller judges. Needs at least two views; base in range.
bool ComputePoseOnlyDepth(std::span<const Pose> T_WC, std::span<const Eigen::Vector2d> z, int base,
                          DepthViews views, PoseOnlyDepth* depth);

/// Parallax gate: true when the depth's relative deviation sigma / sqrt(A^T A) is below
/// `max_relative_deviation`. Noise alone makes A^T A about 4 sigma^2 for each of the `other_views`, which is
/// subtracted first: otherwise a long track at rest would pass. `sigma`: standard deviation on the normalised
/// plane.
[[nodiscard]] bool DepthIsDetermined(const PoseOnlyDepth& depth, int other_views, double sigma,
                                     double max_relative_deviation);

/// Multi-view pose-only reprojection (paper eq. 5-7, 5-8): residual of every view against the landmark that
/// ALL poses and observations define. Residual 2N (the base's two rows vanish), Jacobian through the depth:
/// total derivatives.
struct PoseOnlyModel {
  int base = 0;
  DepthViews views = DepthViews::kMulti;

  using DynamicJacobian = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic>;

  /// residual: 2N, predicted - measured. jacobian: 2N x 6N over the views' (phi, dp). noise_jacobian: 2N x
  /// 2N, d predicted / d z (so that residual noise is (noise_jacobian - I) n). False: no parallax, or the
  /// landmark lies behind a view.
  bool Evaluate(std::span<const Pose> T_WC, std::span<const Eigen::Vector2d> z, PoseOnlyDepth* depth,
                Eigen::VectorXd* residual, DynamicJacobian* jacobian, DynamicJacobian* noise_jacobian) const;
};

}  // namespace alidade
