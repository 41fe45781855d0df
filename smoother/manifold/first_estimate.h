#pragma once

#include "smoother/manifold/state_chart.h"

namespace alidade {

/// Where the Jacobians of a frame are taken once the prior holds it (first estimates, after Huang, Mourikis
/// and Roumeliotis, ISER 2008, and Leutenegger et al., IJRR 2015). The prior is linearised there permanently.
/// Factors linearised elsewhere have a different null space for yaw and position than the prior, and their
/// sum would contain spurious information about them. Residuals are evaluated at the present state.
struct FirstEstimate {
  StateChart chart;  ///< of the prior
  NavState state;    ///< its velocity counts once the prior holds it: from when the frame is the oldest
  bool holds_velocity = false;

  /// The point itself, for a frame that is at `now`.
  [[nodiscard]] NavState Point(const NavState& now) const;
  /// d zeta of the point / d zeta of `now`, 9 x 9, canonical chart: with a Jacobian J taken at the point,
  /// J Chain(now) is over the chart at `now`, such that both move the prior's coordinates alike.
  [[nodiscard]] Matrix9d Chain(const NavState& now) const;
};

}  // namespace alidade
