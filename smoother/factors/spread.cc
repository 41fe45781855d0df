#include "smoother/factors/spread.h"

#include <cmath>

#include "core/lie.h"

namespace alidade {

Spread SpreadOf(std::span<const NavState> states, const Eigen::Vector3d& point_B) {
  const auto count = static_cast<Eigen::Index>(states.size());
  Eigen::Matrix3Xd from_mean(3, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    from_mean.col(i) = states[static_cast<size_t>(i)].T_WB() * point_B;
  }
  from_mean.colwise() -= from_mean.rowwise().mean().eval();
  const double sum = from_mean.squaredNorm();
  Spread spread;
  spread.metres = std::sqrt(sum / static_cast<double>(count));
  spread.slope.resize(6, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Vector3d slope = from_mean.col(i) / sum;
    spread.slope.col(i) << point_B.cross(states[static_cast<size_t>(i)].R_WB.transpose() * slope), slope;
  }
  return spread;
}

Shape ShapeOf(std::span<const NavState> states, const Eigen::Vector3d& point_B) {
  const auto count = static_cast<Eigen::Index>(states.size());
  const Eigen::Matrix3d to_first = states.front().R_WB.transpose();
  const Eigen::Vector3d first_W = states.front().T_WB() * point_B;
  Shape shape;
  shape.positions.resize(3, count);
  shape.jacobian.setZero(3 * count, 6 * count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const NavState& state = states[static_cast<size_t>(i)];
    shape.positions.col(i) = to_first * (state.T_WB() * point_B - first_W);
    auto rows = shape.jacobian.middleRows<3>(3 * i);
    rows.middleCols<3>(6 * i) = -to_first * state.R_WB * Skew(point_B);
    rows.middleCols<3>(6 * i + 3) = to_first;
    rows.leftCols<3>() += Skew(shape.positions.col(i));  // about the first position, which cancels below
  }
  shape.positions.colwise() -= shape.positions.rowwise().mean().eval();
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(3, 6 * count);
  for (Eigen::Index i = 0; i < count; ++i) {
    sum += shape.jacobian.middleRows<3>(3 * i);
  }
  for (Eigen::Index i = 0; i < count; ++i) {
    shape.jacobian.middleRows<3>(3 * i) -= sum / static_cast<double>(count);
  }
  return shape;
}

}  // namespace alidade
