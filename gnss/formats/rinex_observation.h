#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>

#include "gnss/formats/observation.h"

namespace alidade {

/// Reads a RINEX observation file of version 2.xx, 3.xx or 4.xx, plain, Compact RINEX 1 or 3, each of them
/// also as gzip. Sources: RINEX 2.11, 3.05 and 4.00.
///
/// A fault in the header is an error that names file and line. Records that are torn or ill-formed are passed
/// over up to the next epoch and reported in `warnings`; so are epochs that do not come after the one before.
/// Event records (flags 2 to 6) are counted and their header lines obeyed. A file without one good epoch is
/// an error. A last line without a line end is a warning.
Result<ObservationFile> ReadRinexObservation(const std::string& path);

/// The same from memory; `path` is used in messages.
Result<ObservationFile> ParseRinexObservation(const std::string& path, std::string_view text);

/// The same epoch by epoch, for a file of any length, of which a part at a time is held (Compact RINEX: all
/// of it): `take` gets each, and the result holds none; it may be empty, to look at the file alone. `epochs`
/// becomes their number. Errors: as above.
Result<ObservationFile> ScanRinexObservation(const std::string& path,
                                             const std::function<void(ObservationEpoch)>& take,
                                             std::size_t* epochs);

}  // namespace alidade
