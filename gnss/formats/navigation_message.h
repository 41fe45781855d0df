#pragma once

#include <string_view>
#include <vector>

#include "gnss/formats/ephemeris.h"

namespace alidade {

/// One message of a navigation file as its numbers, in the file's order.
struct RawNavMessage {
  SatelliteId satellite;
  CalendarTime epoch;  ///< label in the system's own scale (GLONASS: UTC)
  /// The clock's three numbers, then four a line; blank and missing ones are empty.
  std::vector<std::optional<double>> numbers;
};

/// Turns numbers into an ephemeris. `message` is set where the file has it (RINEX 4), else it is derived
/// from system, number (BeiDou GEO) and data source (Galileo). Errors: the number that is missing or out of
/// range.
Result<KeplerEphemeris> MakeKeplerEphemeris(const RawNavMessage& raw, std::optional<NavMessage> message);
Result<GlonassEphemeris> MakeGlonassEphemeris(const RawNavMessage& raw);

/// BeiDou satellites in geostationary orbit by number: C01 to C05 and C59 to C63.
[[nodiscard]] bool IsBeidouGeo(SatelliteId satellite);

}  // namespace alidade
