#include "filter/measurement_update.h"

#include <cmath>
#include <utility>

namespace alidade {
namespace {

/// Weighted rows in the error of the state's core, with the innovation at the state.
template <typename Kind>
struct CoreRows {
  typename Kind::Residual innovation;
  typename Kind::Jacobian jacobian;
  Eigen::Matrix<double, Kind::kRows, Eigen::Dynamic, 0, Kind::kRows, 3> lever_arm;  ///< of a watched antenna
};

template <typename Kind>
CoreRows<Kind> Linearize(const Kind& measurement, Sensor sensor, const FilterState& state) {
  CoreRows<Kind> rows;
  typename Kind::Residual residual;
  measurement.Evaluate(state.nav(), &residual, nullptr);
  rows.innovation = -residual;
  const NavState& point = state.first_estimates() ? state.nav_first() : state.nav();
  measurement.Evaluate(point, &residual, &rows.jacobian);
  rows.jacobian *= ImuChartJacobian(state.convention(), point);
  rows.lever_arm.resize(Kind::kRows, 0);
  if constexpr (HasLeverArm<Kind>) {
    if (state.layout().antenna() == sensor) {
      rows.lever_arm = measurement.LeverArmJacobian(point);
    }
  }
  return rows;
}

FilterRows OverTheWholeError(const FilterState& state, const Eigen::Ref<const Eigen::MatrixXd>& jacobian,
                             const Eigen::Ref<const Eigen::VectorXd>& innovation) {
  FilterRows rows;
  rows.jacobian = Eigen::MatrixXd::Zero(jacobian.rows(), state.covariance().dimension());
  rows.jacobian.middleCols<SquareRootCovariance::kCore>(state.CoreOffset()) = jacobian;
  rows.innovation = innovation;
  rows.source = RowSource::kMeasurement;
  return rows;
}

}  // namespace

bool MeasurementUpdate::Apply(const WhitenedMeasurement& measurement, FilterState* state,
                              Eigen::Ref<Eigen::VectorXd> correction, FrameStatistics* statistics) {
  correction.setZero();
  const Sensor sensor = SensorOf(measurement);
  SensorStatistics& counts = statistics->sensors[sensor];
  return std::visit(
      [&](const auto& kind) {
        using Kind = std::decay_t<decltype(kind)>;
        CoreRows<Kind> rows = Linearize(kind, sensor, *state);
        const double nis =
            InnovationNis<Kind::kRows>(rows.innovation, rows.jacobian, state->covariance().CoreCovariance());
        const double weight = gates_.Weigh(sensor, nis);
        if (!(weight > 0)) {
          ++counts.gated;
          return true;
        }
        rows.jacobian *= std::sqrt(weight);
        rows.innovation *= std::sqrt(weight);
        rows.lever_arm *= std::sqrt(weight);
        ++counts.used;
        counts.nis_dof = Kind::kRows;
        if (observer_ != nullptr) {
          observer_->OnUpdate(*state, OverTheWholeError(*state, rows.jacobian, rows.innovation));
        }
        return state->covariance().UpdateByBlock(state->CoreOffset(), rows.jacobian, rows.innovation,
                                                 correction, &counts.nis, rows.lever_arm);
      },
      measurement);
}

}  // namespace alidade
