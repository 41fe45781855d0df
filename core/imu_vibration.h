#pragma once

#include <span>

#include "core/imu_sample.h"

namespace alidade {

/// `noise` with what vibration adds to its white densities over consecutive samples (stamps strictly
/// increasing).
///
/// A step of the integration takes the mean of two samples x_k, x_{k+1} as constant. A cubic through the
/// samples around it says that this is wrong by
///
///     e_k = dt / 24 (x_{k-1} - x_k - x_{k+1} + x_{k+2}),
///
/// what the rule does not resolve of the motion between samples. White samples of density N have
/// var(e_k) / dt = N^2 / 144 from it. The mean square of e_k over the interval and the three axes beyond
/// that, over dt, is added to N^2, for gyroscope and accelerometer each; nothing is ever taken off. Only
/// steps of equal length count (within a tenth), so that interpolated ends do not; with none the noise is
/// unchanged.
///
/// Successive e_k nearly cancel, so that as white noise they are rather too large over many steps. Vibration
/// beyond half the sample rate that the sensor folds into its samples is in none of this.
[[nodiscard]] ImuNoise AddVibration(std::span<const ImuSample> samples, const ImuNoise& noise);

}  // namespace alidade
