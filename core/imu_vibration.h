#pragma once

#include <span>

#include "core/imu_sample.h"

namespace alidade {

/// `noise` with what vibration adds to its white densities over consecutive samples (stamps strictly
/// increasing).
///
/// A cubic through the samples around a step and the line through its ends differ by
///
///     e_k = dt / 24 (x_{k-1} - x_k - x_{k+1} + x_{k+2})
///
/// in the integral. The integration takes a parabola (core/imu_step.h), but of vibration near half the sample
/// rate, where e_k is large, it resolves little: its error is then of that size. White samples of density N
/// have var(e_k) / dt = N^2 / 144 from it. The mean square of e_k over the interval and the three axes beyond
/// that, over dt, is added to N^2, for gyroscope and accelerometer each; nothing is ever taken off. Only
/// steps of equal length count (within a tenth), so that interpolated ends do not; with none the noise is
/// unchanged.
///
/// Successive e_k nearly cancel, so that as white noise they are rather too large over many steps. Vibration
/// beyond half the sample rate that the sensor folds into its samples is in none of this.
[[nodiscard]] ImuNoise AddVibration(std::span<const ImuSample> samples, const ImuNoise& noise);

}  // namespace alidade
