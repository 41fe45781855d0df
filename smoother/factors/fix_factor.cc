#include "smoother/factors/fix_factor.h"

#include <cmath>

#include "gnss/alignment/carried_state.h"

namespace alidade {

FrameFixRows LinearizeFrameFix(const FrameFix& fix, const NavState& nav, const ImuBias& bias,
                               const Eigen::Vector3d& gravity_W) {
  FrameFixRows rows;
  if (!(fix.weight > 0)) {
    return rows;
  }
  if (fix.preintegration) {
    Matrix15d carry;
    const NavState carried = CarryState(*fix.preintegration, nav, bias, gravity_W, &carry);
    fix.measurement.Evaluate(carried, &rows.residual, &rows.jacobian);
    rows.jacobian = (rows.jacobian * carry).eval();
  } else {
    fix.measurement.Evaluate(nav, &rows.residual, &rows.jacobian);
  }
  const double root = std::sqrt(fix.weight);
  rows.residual *= root;
  rows.jacobian *= root;
  return rows;
}

bool FixFactor::Evaluate(const double* const* parameters, double* residual,
                         double* const* tangent_jacobians) const {
  const FrameFixRows rows =
      LinearizeFrameFix(*fix_, UnpackNavState(parameters[0]), UnpackBias(parameters[1]), gravity_W_);
  Eigen::Map<Eigen::Vector3d>{residual} = rows.residual;
  if (tangent_jacobians != nullptr && tangent_jacobians[0] != nullptr) {
    Eigen::Map<Eigen::Matrix<double, kRows, 9, Eigen::RowMajor>>{tangent_jacobians[0]} =
        rows.jacobian.leftCols<9>();
  }
  if (tangent_jacobians != nullptr && tangent_jacobians[1] != nullptr) {
    Eigen::Map<Eigen::Matrix<double, kRows, 6, Eigen::RowMajor>>{tangent_jacobians[1]} =
        rows.jacobian.rightCols<6>();
  }
  return true;
}

}  // namespace alidade
