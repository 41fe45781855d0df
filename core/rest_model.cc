#include "core/rest_model.h"

#include "core/check.h"

namespace alidade {

void RestModel::Evaluate(const NavState& state, const ImuBias& bias, Vector6d* residual,
                         Jacobian* jacobian) const {
  *residual << state.v_WB, bias.gyro - mean_gyro_radps;
  if (jacobian != nullptr) {
    jacobian->setZero();
    jacobian->block<6, 6>(0, 6).setIdentity();
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

RestMeasurement MakeRestMeasurement(const RestVerdict& verdict, const Eigen::Vector3d& mean_gyro_radps,
                                    const VisionConfig& vision) {
  CHECK(verdict.no_translation);
  RestMeasurement measurement{{mean_gyro_radps}};
  measurement.sqrt_information.head<3>().setConstant(1 / vision.rest_velocity_std_mps);
  if (verdict.no_rotation) {
    measurement.sqrt_information.tail<3>().setConstant(1 / vision.rest_rate_std_radps);
  }
  return measurement;
}

}  // namespace alidade
