#pragma once

#include <string>

#include "gnss/formats/ephemeris.h"
#include "gnss/formats/observation.h"

namespace alidade {

/// RINEX 3.04 text of an observation file: code, phase, Doppler and C/N0 of every signal that occurs, in GPS
/// time. Values have three decimals, tags seven of a second. What the file's header fields beyond marker,
/// position and GLONASS channels hold is not written.
[[nodiscard]] std::string FormatRinexObservation(const ObservationFile& file);

/// RINEX 3.04 text of a navigation file: LNAV, I/NAV and F/NAV, D1 and D2, FDMA, Klobuchar parameters and
/// leap seconds. Numbers have twelve decimals: read back, an ephemeris is equal to rounding.
[[nodiscard]] std::string FormatRinexNavigation(const NavigationData& data);

}  // namespace alidade
