#pragma once

#include <span>

#include "core/imu_sample.h"
#include "core/navigation_state.h"

namespace alidade {

/// State transition of the error and covariance of its driving noise over an interval, both in the canonical
/// chart (phi, dp, dv, dbg, dba): zeta(t1) = phi zeta(t0) + w, w ~ N(0, q).
struct ImuTransition {
  Matrix15d phi = Matrix15d::Identity();
  Matrix15d q = Matrix15d::Zero();
};

/// One step of length dt with constant angular rate `omega` [rad/s] and specific force `accel` [m/s^2],
/// biases removed. Closed form with Gamma_m of core/lie.h (Hartley et al. 2020):
///
///   R+ = R Exp(w dt)
///   v+ = v + g dt + R Gamma_1(w dt) a dt
///   p+ = p + v dt + g dt^2/2 + R Gamma_2(w dt) a dt^2
///
/// `transition`, when given, is advanced over the step: exact phi, and q with the rotation held at the step's
/// middle (relative error of order (|w| dt)^2).
void PropagateStep(const Eigen::Vector3d& omega, const Eigen::Vector3d& accel, double dt_s,
                   const ImuNoise& noise, const Eigen::Vector3d& gravity_W, NavState* state,
                   ImuTransition* transition);

/// Propagates over consecutive samples; each step uses the mean of its two end samples less the bias. Needs
/// at least two samples; stamps strictly increasing.
void PropagateImu(std::span<const ImuSample> samples, const ImuBias& bias, const ImuNoise& noise,
                  const Eigen::Vector3d& gravity_W, NavState* state, ImuTransition* transition);

/// Gravity in W, z up.
[[nodiscard]] inline Eigen::Vector3d GravityInWorld(double magnitude_mps2) {
  return {0, 0, -magnitude_mps2};
}

}  // namespace alidade
