#pragma once

#include <span>
#include <string>

#include "core/numbers.h"

namespace alidade {

/// A unit that the columns of an IMU table come in.
struct ImuUnit {
  const char* name;
  double per_si;  ///< the figure in this unit of one SI unit
};

inline constexpr double kStandardGravity = 9.80665;
/// The SI unit first.
inline constexpr ImuUnit kGyroUnits[] = {
    {"rad/s", 1}, {"deg/s", kDegreesPerRadian}, {"mrad/s", 1e3}, {"mdeg/s", 1e3 * kDegreesPerRadian}};
inline constexpr ImuUnit kAccelUnits[] = {
    {"m/s^2", 1}, {"g", 1 / kStandardGravity}, {"mg", 1e3 / kStandardGravity}};

/// What motion a camera can follow: root mean square and largest angular rate [rad/s]. Gyroscopes of small
/// rigs saturate at 35 rad/s (2000 deg/s).
inline constexpr double kMostRateRms = 8;
inline constexpr double kMostRate = 40;

/// The unit in which `found` is nearest to `expected` [SI unit] by their ratio, if it is within the factor
/// `band`; else null. Precondition: both positive.
[[nodiscard]] const ImuUnit* NearestUnit(std::span<const ImuUnit> units, double found, double expected,
                                         double band);

/// "deg/s or mrad/s": the units other than rad/s in which rates of this root mean square and largest value
/// are those of a motion that a camera can follow. Empty: none.
[[nodiscard]] std::string PlausibleGyroUnits(double rate_rms, double largest_rate);

}  // namespace alidade
