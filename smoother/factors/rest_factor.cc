#include "smoother/factors/rest_factor.h"

#include "smoother/factors/imu_factor.h"

namespace alidade {

bool RestFactor::Evaluate(const double* const* parameters, double* residual,
                          double* const* tangent_jacobians) const {
  Vector6d r;
  RestModel::Jacobian jacobian;
  measurement_.Evaluate(UnpackNavState(parameters[0]), UnpackBias(parameters[1]), &r, &jacobian);
  Eigen::Map<Vector6d>{residual} = r;
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
