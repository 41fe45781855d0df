#pragma once

#include "core/navigation_state.h"
#include "core/rest_detector.h"
#include "core/vision_config.h"

namespace alidade {

/// A rig whose camera stands still (core/rest_detector.h) while the body may turn about it, and, where it
/// does not turn either, a gyroscope that shows its bias alone,
///
///     r = (v_WB + R_WB (w - b_g) x p_BC, b_g - mean measured rate),   6x1, m/s and rad/s,
///
/// with w the rate measured at the state's stamp. Jacobian over the 15 canonical coordinates (phi, dp, dv,
/// dbg, dba). Neglected: the earth's rotation (7e-5 rad/s, taken for bias), the noise of w, and the
/// correlation of the mean rate with the gyroscope noise of the propagation.
struct RestModel {
  static constexpr int kRows = 6;
  using Jacobian = Eigen::Matrix<double, kRows, 15>;

  RestRates rates;
  Eigen::Vector3d p_BC = Eigen::Vector3d::Zero();  ///< m

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

/// The configured deviations, larger where the verdict's flow is more than that of rest; that of the velocity
/// also where scenery at scene_depth_m hides so slow a motion. Precondition: verdict.no_translation.
[[nodiscard]] RestMeasurement MakeRestMeasurement(const RestVerdict& verdict, double scene_depth_m,
                                                  const RestRates& rates, const Eigen::Vector3d& p_BC,
                                                  const VisionConfig& vision);

}  // namespace alidade
