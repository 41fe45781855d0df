#include "filter/fix_update.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <string>
#include <utility>

namespace alidade {

using Eigen::Vector3d;

FixUpdate::FixUpdate(const FixConfig& config, std::vector<FixSensor> sensors)
    : config_(config), sensors_(std::move(sensors)), gate_(config) {}

Result<FixMeasurement> FixUpdate::Prepare(const PositionFix& fix) const {
  if (fix.sensor < 0 || static_cast<std::size_t>(fix.sensor) >= sensors_.size()) {
    return Status::Input("filter: a position fix of sensor " + std::to_string(fix.sensor) +
                         ", expected one of " + std::to_string(sensors_.size()));
  }
  return MakeFixMeasurement(config_, sensors_[static_cast<std::size_t>(fix.sensor)].p_BA, fix);
}

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
  const Eigen::Matrix3d innovation_covariance =
      jacobian * state->covariance().CoreCovariance() * jacobian.transpose() + Eigen::Matrix3d::Identity();
  const double nis = residual.dot(innovation_covariance.llt().solve(residual));
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
