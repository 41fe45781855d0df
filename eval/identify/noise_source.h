#pragma once

#include <array>
#include <cstddef>

namespace alidade {

/// The noises that are identified in motion, as factors on what a recorded filter assumed.
enum class NoiseSource { kGyro, kAccel, kGyroWalk, kAccelWalk, kPixel, kGnss, kMeasurement };
inline constexpr std::size_t kNoiseSources = 7;
inline constexpr std::size_t kImuNoiseSources = 4;  ///< the first of them
using PerNoise = std::array<double, kNoiseSources>;

[[nodiscard]] constexpr std::size_t IndexOf(NoiseSource source) {
  return static_cast<std::size_t>(source);
}

/// The name in reports: the sensor sheet's key, or what the factor is on.
[[nodiscard]] const char* NameOf(NoiseSource source);
[[nodiscard]] const char* UnitOf(NoiseSource source);

}  // namespace alidade
