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

/// The camera's positions in a window about their mean [m], in the axes of the first body: neither rotation
/// nor shift of the whole window changes them.
struct Shape {
  Eigen::Matrix3Xd positions;
  Eigen::MatrixXd jacobian;  ///< 3F x 6F, over (phi, dp) of the body at each state
};
[[nodiscard]] Shape ShapeOf(std::span<const NavState> states, const Eigen::Vector3d& point_B);

}  // namespace alidade
