#pragma once

#include <Eigen/Core>

#include "core/error_convention.h"

namespace alidade {

/// The errors of a convention in a frame that has W's axes and its origin at `centre`. A right-invariant
/// error turns about that origin, and neglects the square of the angle times the distance from there. The
/// other conventions do not depend on the centre.
struct StateChart {
  ErrorConvention convention = ErrorConvention::kRightInvariant;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< m, in W

  /// A state of W, seen from the centre.
  [[nodiscard]] NavState FromCentre(NavState state) const;
  [[nodiscard]] Pose FromCentre(Pose pose) const;
  /// The xi between two states of W (core/error_convention.h).
  [[nodiscard]] Vector9d Local(const NavState& estimate, const NavState& truth) const;
  /// That of smoother/manifold/nav_state_manifold.h, in this chart.
  [[nodiscard]] Matrix9d LocalJacobian(const NavState& origin, const NavState& state) const;
  /// d zeta / d xi at xi = 0, and its inverse.
  [[nodiscard]] Matrix9d Jacobian(const NavState& state) const;
  [[nodiscard]] Matrix9d InverseJacobian(const NavState& state) const;
  /// Of an error's coordinates here as a function of those in the chart `next`: the derivative of p over
  /// theta. The rest is the identity.
  [[nodiscard]] Eigen::Matrix3d TurnOfCentre(const StateChart& next) const;
};

}  // namespace alidade
