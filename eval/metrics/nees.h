#pragma once

#include <utility>
#include <vector>

#include "eval/metrics/state_pair.h"

namespace alidade {

/// Covariance of the error (phi, dp) of an estimate as the truth shows it, phi = Log(R_est^T R_truth), dp =
/// p_truth - p_est. The truth's own error (phi_t, dp_t), independent of the estimate's, is in the same chart
/// about the truth: R = R_truth Exp(phi_t). To first order phi moves by J_r(phi)^-1 phi_t and dp by dp_t, so
/// that
///
///   P = P_est + J P_truth J^T,   J = blockdiag(J_r(phi)^-1, I)
///
/// which is P_est where the truth has no covariance (zero). Both are in the world of the truth:
/// ApplyAlignment turns P_est there.
[[nodiscard]] Matrix6d ErrorCovariance(const StatePair& pair);

/// NEES of (phi, dp) in the canonical chart against ErrorCovariance, and of velocity and biases, truth -
/// estimate. Unaligned.
struct NeesResult {
  std::vector<double> pose, orientation, position;  ///< one a pair; NaN where the covariance is singular
  /// Means over the regular covariances; NaN when there is none.
  double mean_pose = 0, mean_orientation = 0, mean_position = 0;
  double mean_velocity = 0, mean_gyro_bias = 0, mean_accel_bias = 0;
  double coverage_3sigma = 0;  ///< share of the six error components inside +-3 sigma; NaN likewise
};
[[nodiscard]] NeesResult ComputeNees(const std::vector<StatePair>& pairs);

/// Two-sided chi-square band of the mean of `samples` independent NEES values with `dof` degrees of freedom.
/// Successive frames are correlated: count runs, not frames. NaN for invalid arguments.
[[nodiscard]] std::pair<double, double> NeesBand(int dof, double samples, double probability = 0.95);

/// NEES that an error of `dof` components exceeds with the probability of a Gaussian beyond +-`sigmas`; of a
/// pose (6) 20.1 for 3 sigma, 39.5 for 5.
[[nodiscard]] double NeesOfSigmas(double sigmas, int dof);

}  // namespace alidade
