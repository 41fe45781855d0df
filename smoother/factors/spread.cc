#include "smoother/factors/spread.h"

#include <cmath>

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

}  // namespace alidade
