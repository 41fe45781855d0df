#include "core/inverse_depth.h"

namespace alidade {

bool InverseDepthModel::Evaluate(const Pose& T_WC_base, const Pose& T_WC, double inverse_depth,
                                 Eigen::Vector2d* residual, PoseJacobian* jacobian_base,
                                 PoseJacobian* jacobian_view, Eigen::Vector2d* jacobian_rho,
                                 Eigen::Matrix2d* jacobian_bearing) const {
  const Eigen::Vector3d ray = z_base.homogeneous();
  const Eigen::Vector3d ray_W = T_WC_base.rotation * ray;
  const Eigen::Vector3d shift_W = T_WC_base.translation - T_WC.translation;
  // rho times the landmark in the view's frame: the projection does not see the scale.
  const Eigen::Vector3d q_C = T_WC.rotation.transpose() * (ray_W + inverse_depth * shift_W);
  if (!(q_C.z() > 1e-6)) {
    return false;
  }
  const Eigen::Vector2d predicted = q_C.hnormalized();
  *residual = predicted - z;
  Eigen::Matrix<double, 2, 3> perspective;
  perspective << 1, 0, -predicted.x(), 0, 1, -predicted.y();
  perspective /= q_C.z();
  const Eigen::Matrix<double, 2, 3> to_world = perspective * T_WC.rotation.transpose();
  if (jacobian_base != nullptr) {
    jacobian_base->leftCols<3>() = -to_world * T_WC_base.rotation * Skew(ray);
    jacobian_base->rightCols<3>() = inverse_depth * to_world;
  }
  if (jacobian_view != nullptr) {
    jacobian_view->leftCols<3>() = perspective * Skew(q_C);
    jacobian_view->rightCols<3>() = -inverse_depth * to_world;
  }
  if (jacobian_rho != nullptr) {
    *jacobian_rho = to_world * shift_W;
  }
  if (jacobian_bearing != nullptr) {
    *jacobian_bearing = to_world * T_WC_base.rotation.leftCols<2>();
  }
  return true;
}

}  // namespace alidade
