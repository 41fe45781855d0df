#include "gnss/alignment/fix_rows.h"

#include <cmath>

namespace alidade {

using Eigen::Vector3d;

Vector3d FixGuess::Residual(const FixPoint& point) const {
  const Vector3d turned = transform.Rotation() * (point.p_WA + point.since_newest_s * dv_W);
  return point.sqrt_information * (turned + transform.p_NW - point.p_NA);
}

Eigen::Matrix<double, 3, 7> FixGuess::Jacobian(const FixPoint& point) const {
  NavState antenna;
  antenna.p_WB = point.p_WA + point.since_newest_s * dv_W;
  Eigen::Matrix<double, 3, 7> jacobian;
  jacobian << transform.ParameterJacobian(transform * antenna).middleRows<3>(3),
      point.since_newest_s * transform.Rotation();
  return point.sqrt_information * jacobian;
}

void FixGuess::Move(const Eigen::Matrix<double, 7, 1>& step) {
  transform.yaw_rad = std::remainder(transform.yaw_rad + step[0], 2 * M_PI);
  transform.p_NW += step.segment<3>(1);
  dv_W += step.tail<3>();
}

}  // namespace alidade
