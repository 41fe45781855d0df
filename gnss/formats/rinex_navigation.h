#pragma once

#include <string>
#include <string_view>

#include "gnss/formats/ephemeris.h"

namespace alidade {

/// Reads a RINEX navigation file of version 2.xx (GPS "N", GLONASS "G"; Galileo "E" of 2.12), 3.xx or 4.xx,
/// plain or gzip. Sources: RINEX 2.11, 3.05 and 4.00.
///
/// Used are LNAV of GPS and QZSS, I/NAV and F/NAV of Galileo, D1 and D2 of BeiDou, FDMA of GLONASS, and
/// ionosphere parameters of the header (to 3.xx) or of ION messages (4.xx). Other messages are counted in
/// `passed_over`. A fault in the header is an error; a message that is torn or out of range is passed over
/// and reported in `warnings`. A file without one good ephemeris is an error.
Result<NavigationData> ReadRinexNavigation(const std::string& path);

/// The same from memory; `path` is used in messages.
Result<NavigationData> ParseRinexNavigation(const std::string& path, std::string_view text);

}  // namespace alidade
