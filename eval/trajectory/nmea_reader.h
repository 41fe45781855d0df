#pragma once

#include <optional>
#include <string>
#include <vector>

#include "eval/trajectory/position_file_reader.h"
#include "gnss/base/gnss_time.h"

namespace alidade {

/// Reads the positions of a text of NMEA 0183 sentences: GGA of any talker, its height above the geoid plus
/// the geoid's separation. The date is that of RMC or ZDA sentences, else `date` (UTC, its time of day means
/// nothing); it turns at midnight. Deviations are those of the GST sentence of the same time, else what the
/// quality suggests: RTK fixed 0.02 m, float 0.3 m, differential 0.7 m and single 2.5 m times the HDOP,
/// upwards twice that. Sentences with another checksum, of other types, and solutions that are invalid or
/// dead reckoning are passed over, and those with a stamp not later than the one before. Errors (kInput):
/// file and line of a GGA, RMC, ZDA or GST sentence that is torn; no date; no position.
Result<std::vector<FilePosition>> ReadNmeaFile(const std::string& path,
                                               const std::optional<CalendarTime>& date);

}  // namespace alidade
