#pragma once

#include <cstddef>
#include <span>

#include "core/imu_sample.h"
#include "core/navigation_state.h"

namespace alidade {

/// Angular rate [rad/s] and specific force [m/s^2], bias removed, that have over a step the effect of the
/// measured motion when they are constant in the body. StepIncrement takes them.
struct StepMean {
  Eigen::Vector3d gyro;
  Eigen::Vector3d accel;
  // Derivatives over the measured rate and force, whose bias is removed; that of gyro over accel is zero.
  Eigen::Matrix3d gyro_over_gyro;  ///< and of accel over accel
  Eigen::Matrix3d accel_over_gyro;
};

/// The mean over the step from samples[k] to samples[k + 1] of the parabola through them and the sample
/// before, and of the one through them and the sample after: with both the mean is that of a cubic, with none
/// that of a line. A sample beyond a silence (core/imu_gap.h) does not count. The turn of the axes within the
/// step adds the coning and the sculling term of a rate w and a force f that change linearly (Savage 1998),
///
///     dt/12 w_k x w_{k+1},   dt/12 (w x (f_{k+1} - f_k) - (w_{k+1} - w_k) x f).
///
/// Precondition: k + 1 < samples.size(), stamps strictly increasing.
[[nodiscard]] StepMean MeanOverStep(std::span<const ImuSample> samples, size_t k, const ImuBias& bias);

/// A sample between the last two of three, moved from the line through these onto the parabola through all.
/// It stays where a silence lies between any two of them.
[[nodiscard]] ImuSample OntoParabola(const ImuSample& before, const ImuSample& from, const ImuSample& to,
                                     const ImuSample& on_line);

}  // namespace alidade
