#include "smoother/factors/fix_factor.h"

#include "core/imu_propagation.h"

namespace alidade {

bool FixFactor::Evaluate(const double* const* parameters, double* residual,
                         double* const* tangent_jacobians) const {
  NavState nav = UnpackNavState(parameters[0]);
  Matrix15d carry = Matrix15d::Identity();
  if (fix_->preintegration) {
    nav = CarryState(*fix_->preintegration, nav, UnpackBias(parameters[1]), gravity_W_, &carry);
  }
  Eigen::Vector3d whitened;
  PositionFixModel::Jacobian jacobian;
  fix_->measurement.Evaluate(nav, &whitened, &jacobian);
  Eigen::Map<Eigen::Vector3d>{residual} = whitened;
  jacobian = (jacobian * carry).eval();
  if (tangent_jacobians != nullptr && tangent_jacobians[0] != nullptr) {
    Eigen::Map<Eigen::Matrix<double, kRows, 9, Eigen::RowMajor>>{tangent_jacobians[0]} =
        jacobian.leftCols<9>();
  }
  if (tangent_jacobians != nullptr && tangent_jacobians[1] != nullptr) {
    Eigen::Map<Eigen::Matrix<double, kRows, 6, Eigen::RowMajor>>{tangent_jacobians[1]} =
        jacobian.rightCols<6>();
  }
  return true;
}

}  // namespace alidade
