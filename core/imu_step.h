#pragma once

#include <span>

#include "core/imu_sample.h"
#include "core/navigation_state.h"

namespace alidade {

/// Fills the curvatures of the last of three consecutive measured samples. Zero when a silence lies between
/// any two of them (core/imu_gap.h), or the last step is more than twice as long as the one before: extended
/// that far, the parabola multiplies the noise of the samples.
void SetCurvature(const ImuSample& first, const ImuSample& second, ImuSample* last);
/// The same for all from the third of consecutive measured samples on.
void SetCurvatures(std::span<ImuSample> samples);

/// Mean (gyro, accel) [rad/s, m/s^2], 6x1, bias removed, over the step between two consecutive samples of the
/// parabola through them whose curvature is that of `to`.
[[nodiscard]] Vector6d ParabolaMean(const ImuSample& from, const ImuSample& to, const ImuBias& bias);

/// Angular rate [rad/s] and specific force [m/s^2], bias removed, that have over a step the effect of the
/// measured motion when they are constant in the body. StepIncrement takes them.
struct StepMean {
  Eigen::Vector3d gyro;
  Eigen::Vector3d accel;
  // Derivatives over a shift of both samples, as a bias is; that of gyro over accel is zero.
  Eigen::Matrix3d gyro_over_gyro;  ///< and of accel over accel
  Eigen::Matrix3d accel_over_gyro;
};

/// ParabolaMean with the effect of the turning body. The turn of the axes within the step adds the coning and
/// the sculling term of a rate w and a force f that change linearly (Savage 1998),
///
///     dt/12 w_k x w_{k+1},   dt/12 (w x (f_{k+1} - f_k) - (w_{k+1} - w_k) x f);
///
/// not in a silence, where the step is not short for the series behind it and the motion is not known.
[[nodiscard]] StepMean MeanOverStep(const ImuSample& from, const ImuSample& to, const ImuBias& bias);

}  // namespace alidade
