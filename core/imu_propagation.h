#pragma once

#include <span>

#include "core/imu_sample.h"
#include "core/navigation_state.h"
#include "core/preintegration.h"

namespace alidade {

/// The error over an interval in the canonical chart (phi, dp, dv, dbg, dba): zeta(t1) = phi zeta(t0) +
/// noise_root n, n ~ N(0, I_15).
struct ImuTransition {
  Matrix15d phi = Matrix15d::Identity();
  Matrix15d noise_root = Matrix15d::Zero();

  /// Covariance of the noise over the interval.
  [[nodiscard]] Matrix15d q() const;
};

/// The state at the end of a preintegrated interval that begins at `nav` with `bias`:
///
///   R' = R gamma(b),  p' = p + v T + g T^2 / 2 + R alpha(b),  v' = v + g T + R beta(b)
///
/// `phi`: 15x15 over (phi, dp, dv, dbg, dba) of both, exact; may be null.
[[nodiscard]] NavState CarryState(const Preintegration& preintegration, const NavState& nav,
                                  const ImuBias& bias, const Eigen::Vector3d& gravity_W, Matrix15d* phi);

/// The transition over a preintegrated interval that begins at `nav` with the bias it was integrated with.
/// kDiverged, with nothing changed: the noise covariance or the state at the end is not finite, as after a
/// sample beyond all physical sizes.
Status PropagateState(const Preintegration& preintegration, const Eigen::Vector3d& gravity_W, NavState* nav,
                      ImuTransition* transition);

/// The same for a state with covariance and bias: carries `estimate` over consecutive samples (at least two;
/// stamps strictly increasing) and sets its stamp.
Status PropagateEstimate(std::span<const ImuSample> samples, const ImuNoise& noise,
                         const Eigen::Vector3d& gravity_W, NavEstimate* estimate);

/// Gravity in W, z up.
[[nodiscard]] inline Eigen::Vector3d GravityInWorld(double magnitude_mps2) {
  return {0, 0, -magnitude_mps2};
}

}  // namespace alidade
