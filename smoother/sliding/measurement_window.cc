#include "smoother/sliding/measurement_window.h"

#include <cmath>
#include <utility>

namespace alidade {

template <typename Kind>
double MeasurementWindow::WeighAndCount(const Kind& measurement, Sensor sensor, const NavEstimate& predicted,
                                        SensorStatistics* counts) {
  typename Kind::Residual residual;
  typename Kind::Jacobian jacobian;
  measurement.Evaluate(predicted.nav, &residual, &jacobian);
  const double weight =
      gates_.Weigh(sensor, InnovationNis<Kind::kRows>(residual, jacobian, predicted.covariance));
  if (!(weight > 0)) {
    ++counts->gated;
    return weight;
  }
  residual *= std::sqrt(weight);
  jacobian *= std::sqrt(weight);
  ++counts->used;
  counts->nis += InnovationNis<Kind::kRows>(residual, jacobian, predicted.covariance);
  counts->nis_dof += Kind::kRows;
  return weight;
}

bool MeasurementWindow::Attach(const WhitenedMeasurement& measurement, const NavEstimate& predicted,
                               std::vector<ImuSample> imu, const ImuNoise& noise, WindowFrame* frame,
                               FrameStatistics* statistics) {
  const Sensor sensor = SensorOf(measurement);
  const double weight = std::visit(
      [&](const auto& kind) { return WeighAndCount(kind, sensor, predicted, &statistics->sensors[sensor]); },
      measurement);
  if (!(weight > 0)) {
    return false;
  }
  FrameMeasurement attached;
  attached.measurement = measurement;
  attached.ScaleSqrtInformation(std::sqrt(weight));
  attached.Set(std::move(imu), frame->imu_bias(), noise);
  frame->measurements.push_back(std::move(attached));
  return true;
}

}  // namespace alidade
