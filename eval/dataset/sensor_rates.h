#pragma once

#include <limits>

#include "core/imu_gap.h"

namespace alidade {

/// Rates [Hz] that a kind of sensor has.
struct RateLimits {
  double least_hz = 0;  ///< an error below
  double low_hz = 0;    ///< a warning below
  double high_hz = 0;   ///< a warning above
  double most_hz = 0;   ///< an error above
  /// Stamps of more than high_hz are in another unit if that unit gives a rate above this and up to high_hz.
  double unit_hz = 0;
};

/// Motion of a body that carries a camera reaches 10 to 20 Hz, so sampling begins to lose it below 50 Hz;
/// logs of phones have 25 Hz. No MEMS sensor samples faster than 32 kHz. Longer steps than
/// imu_gap::kMinGapS are silences: the estimators add their noise, and the states are degraded. An IMU whose
/// steps become so long by jitter of a fifth, as loggers on phones have, is always silent: at 12 Hz. Unit:
/// above what the fastest sensor, read as microseconds, would have.
inline constexpr RateLimits kImuRates{1.2 / imu_gap::kMinGapS, 50, 1e4, 1e5, 33};
/// Keyframes may be many seconds apart. Cameras with a sensor of a megapixel end at some 200 Hz, those that
/// render events at 1 kHz. Unit: cameras of 10 Hz and more of which a fifth of the frames is lost.
inline constexpr RateLimits kCameraRates{0, 0, 250, 1e4, 8};
/// Receivers deliver at most 100 raw epochs a second; reference stations one in 30 s.
inline constexpr RateLimits kGnssRates{0, 0, 110, 1e4, 0};
/// Of truth and position fixes, whose rates range too widely to identify a unit; UnitByReference does.
inline constexpr RateLimits kAnyRates{0, 0, std::numeric_limits<double>::infinity(),
                                      std::numeric_limits<double>::infinity(), 0};

}  // namespace alidade
