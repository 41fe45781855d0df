#pragma once

#include <Eigen/Core>

#include "core/error_convention.h"

namespace alidade {

/// The errors of a convention as they are in a frame that has W's axes and its origin at `centre`. The
/// right-invariant error turns about the origin: what it neglects of a turn, the square of the angle times
/// the distance from there, is that from the centre. The other conventions do not depend on it.
struct StateChart {
  ErrorConvention convention = ErrorConvention::kRightInvariant;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< m, in W

  /// A state of W, seen from the centre.
  [[nodiscard]] NavState FromCentre(NavState state) const;
  [[nodiscard]] Pose FromCentre(Pose pose) const;
  /// The xi between two states of W (core/error_convention.h).
  [[nodiscard]] Vector9d Local(const NavState& estimate, const NavState& truth) const;
  /// d Local(origin, Retract(state, xi)) / d xi at xi = 0: the identity where state == origin. A prior
  /// anchored at `origin` needs it wherever the state has moved on.
  [[nodiscard]] Matrix9d LocalJacobian(const NavState& origin, const NavState& state) const;
  /// d zeta / d xi at xi = 0, and its inverse.
  [[nodiscard]] Matrix9d Jacobian(const NavState& state) const;
  [[nodiscard]] Matrix9d InverseJacobian(const NavState& state) const;
  /// d p of xi / d theta of the same error in the chart `next`, whose p it has besides.
  [[nodiscard]] Eigen::Matrix3d TurnOfCentre(const StateChart& next) const;
};

}  // namespace alidade
