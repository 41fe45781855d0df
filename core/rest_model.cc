#include "core/rest_model.h"

#include <algorithm>

#include "core/check.h"
#include "core/lever_arm.h"

namespace alidade {
namespace {

// The largest part of the flow at rest, in standard deviations: nine in ten are below.
constexpr double kUsualFlow = 2.5;

}  // namespace

void RestModel::Evaluate(const NavState& state, const ImuBias& bias, Vector6d* residual,
                         Jacobian* jacobian) const {
  LeverArm::Jacobian camera;
  *residual << LeverArm{p_BC}.Velocity(state, bias, rates.at_end_radps,
                                       jacobian != nullptr ? &camera : nullptr),
      bias.gyro - rates.mean_radps;
  if (jacobian != nullptr) {
    jacobian->topRows<3>() = camera;
    jacobian->bottomRows<3>().setZero();
    jacobian->block<3, 3>(3, 9).setIdentity();
  }
}

void RestMeasurement::Evaluate(const NavState& state, const ImuBias& bias, Vector6d* residual,
                               RestModel::Jacobian* jacobian) const {
  model.Evaluate(state, bias, residual, jacobian);
  residual->array() *= sqrt_information.array();
  if (jacobian != nullptr) {
    jacobian->array().colwise() *= sqrt_information.array();
  }
}

RestMeasurement MakeRestMeasurement(const RestVerdict& verdict, double scene_depth_m, const RestRates& rates,
                                    const Eigen::Vector3d& p_BC, const VisionConfig& vision) {
  CHECK(verdict.no_translation);
  RestMeasurement measurement{{rates, p_BC}};
  const double factor = std::max(1.0, verdict.flow_deviations / kUsualFlow);
  const double velocity_std_mps =
      std::max(factor * vision.rest_velocity_std_mps, verdict.speed_per_depth * scene_depth_m);
  measurement.sqrt_information.head<3>().setConstant(1 / velocity_std_mps);
  if (verdict.no_rotation) {
    measurement.model.rates.at_end_radps = rates.mean_radps;  // the same, less its noise
    measurement.sqrt_information.tail<3>().setConstant(1 / (factor * vision.rest_rate_std_radps));
  }
  return measurement;
}

}  // namespace alidade
