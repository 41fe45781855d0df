#include "smoother/sliding/fix_window.h"

#include <cmath>
#include <utility>

namespace alidade {

FixWindow::FixWindow(const FixConfig& config, std::vector<FixSensor> sensors)
    : config_(config), sensors_(std::move(sensors)), gate_(config) {}

void FixWindow::Attach(const FixMeasurement& fix, const NavEstimate& predicted, std::vector<ImuSample> imu,
                       const ImuNoise& noise, WindowFrame* frame, FrameStatistics* statistics) {
  Eigen::Vector3d residual;
  PositionFixModel::Jacobian jacobian;
  fix.Evaluate(predicted.nav, &residual, &jacobian);
  const double weight = gate_.Weigh(FixNis(residual, jacobian, predicted.covariance));
  if (!(weight > 0)) {
    ++statistics->fixes_gated;
    return;
  }
  const double root = std::sqrt(weight);
  ++statistics->fixes_used;
  statistics->fix_nis += FixNis(root * residual, root * jacobian, predicted.covariance);
  statistics->fix_nis_dof += PositionFixModel::kRows;
  FrameFix attached;
  attached.measurement = fix;
  attached.measurement.sqrt_information *= root;
  attached.Set(std::move(imu), frame->imu_bias(), noise);
  frame->fixes.push_back(std::move(attached));
}

}  // namespace alidade
