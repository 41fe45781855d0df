#pragma once

#include <Eigen/Core>
#include <span>

#include "core/navigation_state.h"

namespace alidade {

/// How far the camera gets about in a window: the root of the mean squared distance of its positions from
/// their mean [m]. It is proportional to the scale of the window.
struct Spread {
  double metres = 0;
  /// d ln(metres) / d (phi, dp) of the body at each state; not finite where it does not move.
  Eigen::Matrix<double, 6, Eigen::Dynamic> slope;
};
/// point_B: the camera in the body [m].
[[nodiscard]] Spread SpreadOf(std::span<const NavState> states, const Eigen::Vector3d& point_B);

}  // namespace alidade
