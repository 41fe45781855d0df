#pragma once

#include "gnss/base/geodesy.h"
#include "gnss/formats/ephemeris.h"

namespace alidade {

/// Ionospheric delay of a pseudorange on GPS L1 [m] by GPS's Klobuchar model (IS-GPS-200 20.3.3.5.2.5). About
/// half of the delay is removed, so that its deviation is taken as half the value.
[[nodiscard]] double KlobucharDelayL1(const KlobucharParameters& parameters, const GeodeticPosition& receiver,
                                      const Direction& direction, TimeNs stamp_ns);

/// The same by BeiDou's model of eight parameters (BDS-SIS-ICD-B1I 5.2.4.7), which is stated for B1I, scaled
/// to L1.
[[nodiscard]] double BeidouKlobucharDelayL1(const KlobucharParameters& parameters,
                                            const GeodeticPosition& receiver, const Direction& direction,
                                            TimeNs stamp_ns);

/// Tropospheric delay [m]: Saastamoinen's zenith delays (1972) for a standard atmosphere of 15 degC and
/// 1013.25 hPa at sea level and 70 % humidity, mapped by Niell (1996), hydrostatic with season and height.
/// Heights outside -100 m to 10 km and elevations below 3 deg are taken at these bounds.
[[nodiscard]] double TroposphereDelay(const GeodeticPosition& receiver, double elevation_rad,
                                      TimeNs stamp_ns);

/// Niell's mapping functions alone.
struct NiellMapping {
  double hydrostatic = 1;
  double wet = 1;
};
[[nodiscard]] NiellMapping NiellMappingAt(const GeodeticPosition& receiver, double elevation_rad,
                                          TimeNs stamp_ns);

}  // namespace alidade
