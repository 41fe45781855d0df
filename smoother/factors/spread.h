#pragma once

#include <Eigen/Core>
#include <span>

#include "core/navigation_state.h"

namespace alidade {

/// How far a point of the body, the camera, gets about in a window: the root of its mean squared distance
/// from its mean position. Of all lengths of a window this one changes in proportion with its scale.
struct Spread {
  double metres = 0;
  Eigen::Matrix<double, 6, Eigen::Dynamic>
      slope;  ///< d ln(metres) / d (phi, dp) of each state; not finite at 0 m
};
[[nodiscard]] Spread SpreadOf(std::span<const NavState> states, const Eigen::Vector3d& point_B);

}  // namespace alidade
