#pragma once

#include <string>
#include <vector>

#include "core/status.h"
#include "core/time.h"

namespace alidade {

/// Times of the frames of an external run [ms].
struct ExternalTimes {
  std::vector<double> frontend_ms;
  std::vector<double> backend_ms;
  std::vector<TimeNs> stamps_ns;  ///< of the frames; empty when the file has none
};

/// Reads a timing.csv with the columns `frontend_ms` and `backend_ms`, wherever they stand, and
/// `timestamp_ns` where it has it. kInput: the file is missing or has no row, one of the two columns is
/// missing, a number is not finite or not a stamp.
Result<ExternalTimes> ReadExternalTimes(const std::string& path);

}  // namespace alidade
