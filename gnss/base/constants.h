#pragma once

namespace alidade {

/// Speed of light in vacuum [m/s].
inline constexpr double kSpeedOfLight = 299792458.0;
/// Earth's rotation rate [rad/s] (WGS 84, GTRF; IS-GPS-200 20.3.3.4.3.3). BeiDou and GLONASS have their own
/// in their orbit models; the Sagnac terms use this one for all (relative difference 2e-8).
inline constexpr double kEarthRotationRate = 7.2921151467e-5;

}  // namespace alidade
