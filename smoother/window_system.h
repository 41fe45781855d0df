#pragma once

#include <vector>

#include "smoother/gnss_factors.h"
#include "smoother/prior_factor.h"
#include "smoother/track_system.h"

namespace alidade {

/// Whitened rows of an IMU factor between two frames at their present states, over the 15 canonical
/// coordinates of each.
struct ImuRows {
  Matrix15d first, second;
  Vector15d residual;
};
/// second.preintegration must be there.
[[nodiscard]] ImuRows LinearizeImu(const WindowFrame& first, const WindowFrame& second,
                                   const Eigen::Vector3d& gravity_W);

/// Covariance of the newest frame (canonical chart, phi dp dv dbg dba) from the Gauss-Newton Hessian of the
/// window at its present states: prior, IMU, rest and `vision` (all landmarks eliminated, kernels included).
/// False when it is not positive definite.
/// `gnss`: of an aligned window, whose epochs and clocks then count; clock_covariance is that of the newest.
bool NewestCovariance(const Window& window, const LinearPrior& prior, const PoseSystem& vision,
                      const Eigen::Vector3d& gravity_W, Matrix15d* covariance,
                      const GnssFactorContext* gnss = nullptr, Matrix6d* clock_covariance = nullptr);

/// Marginalises the oldest frame: the old prior, its rest measurement, the IMU factor to the next frame and
/// `vision` (the tracks that leave with it) are stacked as whitened rows, linearised at the present states,
/// and QR eliminates the frame's 15 columns. What remains is the exact Schur complement as a square root;
/// nothing is inverted, so directions without information need no care.
///
/// The new prior is anchored at the present states. The old prior's rows are carried over with their Jacobian
/// unchanged (first estimates): re-linearising them would let a direction that was never observed leak in.
/// With right-invariant errors the gauge directions are the same at every state, so they are then kept
/// exactly.
/// Of an aligned window (`gnss`) its epochs and its clock leave with it, tied to the next frame's clock.
LinearPrior MarginalizeOldest(const Window& window, const LinearPrior& prior, const PoseSystem& vision,
                              const Eigen::Vector3d& gravity_W, const GnssFactorContext* gnss = nullptr);

}  // namespace alidade
