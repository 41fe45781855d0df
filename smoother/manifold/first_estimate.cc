#include "smoother/manifold/first_estimate.h"

namespace alidade {

NavState FirstEstimate::Point(const NavState& now) const {
  return {state.R_WB, state.p_WB, holds_velocity ? state.v_WB : now.v_WB};
}

Matrix9d FirstEstimate::Chain(const NavState& now) const {
  const NavState point = Point(now);
  return chart.Jacobian(point) * chart.LocalJacobian(point, now) * chart.InverseJacobian(now);
}

}  // namespace alidade
