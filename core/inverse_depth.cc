#include "core/inverse_depth.h"

#include "core/reprojection.h"

namespace alidade {

bool InverseDepthModel::Evaluate(const Pose& T_WA, const Pose& T_WC, const Eigen::Vector3d& landmark,
                                 Eigen::Vector2d* residual, PoseJacobian* jacobian_anchor,
                                 PoseJacobian* jacobian_view, LandmarkJacobian* jacobian_landmark) const {
  const AnchoredPointInCamera seen(T_WA, T_WC, landmark, anchor_plane);
  Eigen::Vector2d predicted;
  Eigen::Matrix<double, 2, 3> over_q;
  if (!ProjectToPlane(plane, seen.q, kMinScaledDepth, &predicted, &over_q)) {
    return false;
  }
  *residual = predicted - z;
  seen.Chain(over_q, jacobian_anchor, jacobian_view, jacobian_landmark);
  return true;
}

}  // namespace alidade
