#pragma once

#include "core/navigation_state.h"
#include "core/rest_detector.h"
#include "core/vision_config.h"

namespace alidade {

/// A rig that stands still (core/rest_detector.h): zero velocity, and a gyroscope that shows its bias alone,
///
///     r = (v_WB - 0, b_g - mean measured rate),   6x1, m/s and rad/s.
///
/// Jacobian over the 15 canonical coordinates (phi, dp, dv, dbg, dba); constant. Neglected: the earth's
/// rotation (7e-5 rad/s, taken for bias) and the correlation of the mean rate with the gyroscope noise of the
/// propagation.
struct RestModel {
  static constexpr int kRows = 6;
  using Jacobian = Eigen::Matrix<double, kRows, 15>;

  Eigen::Vector3d mean_gyro_radps = Eigen::Vector3d::Zero();

  void Evaluate(const NavState& state, const ImuBias& bias, Vector6d* residual, Jacobian* jacobian) const;
};

/// RestModel with its noise: what both back ends use of a verdict.
struct RestMeasurement {
  RestModel model;
  /// Reciprocal standard deviations of the rows; the last three are zero when the rig may turn.
  Vector6d sqrt_information = Vector6d::Zero();

  /// Whitened.
  void Evaluate(const NavState& state, const ImuBias& bias, Vector6d* residual,
                RestModel::Jacobian* jacobian) const;
};

/// Precondition: verdict.no_translation.
[[nodiscard]] RestMeasurement MakeRestMeasurement(const RestVerdict& verdict,
                                                  const Eigen::Vector3d& mean_gyro_radps,
                                                  const VisionConfig& vision);

}  // namespace alidade
