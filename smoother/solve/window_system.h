#pragma once

#include "smoother/factors/gnss_factors.h"
#include "smoother/factors/slam_prior.h"

namespace alidade {

/// Covariance of the newest frame (canonical chart, phi dp dv dbg dba) from the Gauss-Newton Hessian of the
/// window at its present states: prior, IMU, rest and `vision` (all landmarks eliminated, kernels included).
/// False when it is not positive definite.
/// `slam`: a prior with landmarks at the present states, which then stands for `prior`.
/// `gnss`: of an aligned window, whose epochs and clocks then count; clock_covariance is that of the newest.
/// calibration_deviations: of the calibration that `vision` and `prior` hold.
bool NewestCovariance(const Window& window, const LinearPrior& prior, const PoseSystem& vision,
                      const Eigen::Vector3d& gravity_W, Matrix15d* covariance,
                      const GnssFactorContext* gnss = nullptr, Matrix6d* clock_covariance = nullptr,
                      const SlamPrior::Reduced* slam = nullptr,
                      Eigen::VectorXd* calibration_deviations = nullptr);

}  // namespace alidade
