#include "smoother/manifold/first_estimate.h"

#include "smoother/manifold/nav_state_manifold.h"

namespace alidade {

NavState FirstEstimate::Point(const NavState& now) const {
  return {state.R_WB, state.p_WB, holds_velocity ? state.v_WB : now.v_WB};
}

Matrix9d FirstEstimate::Chain(const NavState& now) const {
  const NavState point = Point(now);
  return ChartJacobian(convention, point) * LocalJacobian(convention, point, now) *
         InverseChartJacobian(convention, now);
}

}  // namespace alidade
