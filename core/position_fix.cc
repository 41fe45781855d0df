#include "core/position_fix.h"

#include <string>

#include "core/dense_solvers.h"
#include "core/lever_arm.h"

namespace alidade {

Eigen::Vector3d PositionFixModel::Predict(const NavState& state) const {
  return LeverArm{p_BA}.Position(state);
}

void PositionFixModel::Evaluate(const NavState& state, Eigen::Vector3d* residual, Jacobian* jacobian) const {
  *residual = LeverArm{p_BA}.Position(state, jacobian) - p_WA;
}

void FixMeasurement::Evaluate(const NavState& state, Residual* residual, Jacobian* jacobian) const {
  model.Evaluate(state, residual, jacobian);
  *residual = (sqrt_information * *residual).eval();
  if (jacobian != nullptr) {
    *jacobian = (sqrt_information * *jacobian).eval();
  }
}

void FixMeasurement::ScaleSqrtInformation(double root) {
  sqrt_information *= root;
}

Result<FixMeasurement> MakeFixMeasurement(const FixConfig& config, const Eigen::Vector3d& p_BA,
                                          const PositionFix& fix) {
  const auto fault = [&](const char* expected) {
    return Status::Input("the position fix at " + FormatSeconds(fix.stamp_ns) + " s: expected " + expected);
  };
  if (!fix.p_A.allFinite() || !fix.covariance.allFinite()) {
    return fault("finite numbers");
  }
  constexpr double kRounding = 1e-9;
  const double asymmetry = (fix.covariance - fix.covariance.transpose()).cwiseAbs().maxCoeff();
  if (asymmetry > kRounding * fix.covariance.cwiseAbs().maxCoeff() || !IsPositiveDefinite(fix.covariance)) {
    return fault("a covariance that is symmetric and positive definite");
  }
  const Eigen::Matrix3d assumed = config.std_scale * config.std_scale * fix.covariance +
                                  config.std_floor_m * config.std_floor_m * Eigen::Matrix3d::Identity();
  FixMeasurement measurement;
  measurement.model = {p_BA, fix.p_A};
  measurement.sqrt_information = Whitener(assumed);
  return measurement;
}

Result<FixMeasurement> MakeFixMeasurement(const FixConfig& config, const std::vector<FixSensor>& sensors,
                                          const PositionFix& fix) {
  const auto sensor = static_cast<std::size_t>(fix.sensor);
  if (fix.sensor < 0 || sensor >= sensors.size()) {
    return Status::Input("the position fix at " + FormatSeconds(fix.stamp_ns) + " s: found sensor " +
                         std::to_string(fix.sensor) + ", expected one of " + std::to_string(sensors.size()));
  }
  return MakeFixMeasurement(config, sensors[sensor].p_BA, fix);
}

MeasurementGate MakeFixGate(const FixConfig& config) {
  return {PositionFixModel::kRows,
          config.gate_probability,
          config.max_refused_run,
          {config.robust_kernel, config.robust_scale_sigma}};
}

}  // namespace alidade
