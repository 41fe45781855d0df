#pragma once

#include "core/imu_sample.h"

namespace alidade {

/// Silences of an IMU. They are bridged by linear interpolation, and what the motion did meanwhile is not
/// known. All steps of the integration that lie in one get a white noise whose variance over the whole
/// silence is that of a constant error:
///
///     N^2 += sigma^2 T,   sigma = max(floor, |x_1 - x_0| / 2)
///
/// T: length of the silence; x_0, x_1: samples before and after it. Floors: 0.2 rad/s and 1 m/s^2, what a
/// walking person or a slow vehicle does.
namespace imu_gap {

/// Shorter intervals between samples are those of a slow IMU.
inline constexpr double kMinGapS = 0.1;

/// The floors.
inline constexpr double kMinGyroRadps = 0.2;
inline constexpr double kMinAccelMps2 = 1;

/// Whether the step between two consecutive samples of an interval lies in a silence.
[[nodiscard]] bool IsInside(const ImuSample& from, const ImuSample& to);

/// `noise` of such a step.
[[nodiscard]] ImuNoise AddNoise(const ImuSample& from, const ImuSample& to, const ImuNoise& noise);

}  // namespace imu_gap
}  // namespace alidade
