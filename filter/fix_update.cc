#include "filter/fix_update.h"

#include <cmath>
#include <utility>

namespace alidade {

using Eigen::Vector3d;

FixUpdate::FixUpdate(const FixConfig& config, std::vector<FixSensor> sensors)
    : config_(config), sensors_(std::move(sensors)), gate_(config) {}

bool FixUpdate::Apply(const FixMeasurement& fix, FilterState* state, Eigen::Ref<Eigen::VectorXd> correction,
                      FrameStatistics* statistics) {
  correction.setZero();
  Vector3d residual;
  Vector3d ignored;
  PositionFixModel::Jacobian jacobian;
  fix.Evaluate(state->nav(), &residual, nullptr);
  const NavState& point = state->first_estimates() ? state->nav_first() : state->nav();
  fix.Evaluate(point, &ignored, &jacobian);
  jacobian *= ImuChartJacobian(state->convention(), point);
  const double nis = FixNis(residual, jacobian, state->covariance().CoreCovariance());
  const double weight = gate_.Weigh(nis);
  if (!(weight > 0)) {
    ++statistics->fixes_gated;
    return std::isfinite(nis);
  }
  jacobian *= std::sqrt(weight);
  const Vector3d innovation = -std::sqrt(weight) * residual;
  ++statistics->fixes_used;
  statistics->fix_nis_dof = PositionFixModel::kRows;
  if (observer_ != nullptr) {
    Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(PositionFixModel::kRows, state->covariance().dimension());
    rows.middleCols<SquareRootCovariance::kCore>(state->CoreOffset()) = jacobian;
    observer_->OnUpdate(*state, {std::move(rows), innovation, {}});
  }
  return state->covariance().UpdateByBlock(state->CoreOffset(), jacobian, innovation, correction,
                                           &statistics->fix_nis);
}

}  // namespace alidade
