#include "smoother/manifold/state_chart.h"

#include "smoother/manifold/nav_state_manifold.h"

namespace alidade {

NavState StateChart::FromCentre(NavState state) const {
  state.p_WB -= centre;
  return state;
}

Pose StateChart::FromCentre(Pose pose) const {
  pose.translation -= centre;
  return pose;
}

Vector9d StateChart::Local(const NavState& estimate, const NavState& truth) const {
  return alidade::Local(convention, FromCentre(estimate), FromCentre(truth));
}

Matrix9d StateChart::LocalJacobian(const NavState& origin, const NavState& state) const {
  return alidade::LocalJacobian(convention, FromCentre(origin), FromCentre(state));
}

Matrix9d StateChart::Jacobian(const NavState& state) const {
  return ChartJacobian(convention, FromCentre(state));
}

Matrix9d StateChart::InverseJacobian(const NavState& state) const {
  return InverseChartJacobian(convention, FromCentre(state));
}

Eigen::Matrix3d StateChart::TurnOfCentre(const StateChart& next) const {
  // The same for every pose.
  const Pose pose;
  const Matrix6d change =
      InverseChartJacobian(convention, FromCentre(pose)) * ChartJacobian(convention, next.FromCentre(pose));
  return change.bottomLeftCorner<3, 3>();
}

}  // namespace alidade
