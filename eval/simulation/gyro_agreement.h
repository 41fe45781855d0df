#pragma once

#include <Eigen/Core>
#include <span>

#include "core/imu_sample.h"
#include "core/status.h"
#include "eval/simulation/continuous_trajectory.h"

namespace alidade {

/// How well a gyroscope agrees with a motion that was recorded beside it.
struct GyroAgreement {
  int samples = 0;
  Eigen::Vector3d bias = Eigen::Vector3d::Zero();  ///< gyroscope minus motion [rad/s]
  double time_offset_s = 0;       ///< t_motion = t_imu + offset: positive when the motion is stamped late
  double residual_rms_radps = 0;  ///< of one axis, after bias and time offset
  double motion_rms_radps = 0;    ///< of one axis: angular rate less its mean
  double correlation = 0;         ///< of measured and predicted rate, all axes
};

/// Fits w_imu(t) = w(t + offset) + bias in the least-squares sense to the samples within the motion (at most
/// 5000 of them, evenly picked). `start_ns` is the stamp of the motion's time 0. Body frames that differ by a
/// rotation, clocks that differ by more than a fraction of the motion's period and wrong units all show as a
/// residual of the size of the motion. Neglected: scale errors, walking bias. Errors (kInput): fewer than 100
/// samples within the motion.
Result<GyroAgreement> CompareGyro(const ContinuousTrajectory& motion, TimeNs start_ns,
                                  std::span<const ImuSample> imu);

}  // namespace alidade
