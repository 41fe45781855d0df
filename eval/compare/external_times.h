#pragma once

#include <string>
#include <vector>

#include "core/status.h"

namespace alidade {

/// Times of the frames of an external run [ms].
struct ExternalTimes {
  std::vector<double> frontend_ms;
  std::vector<double> backend_ms;
};

/// Reads a timing.csv with the columns `frontend_ms` and `backend_ms`, wherever they stand. kInput: the file
/// is missing or has no row, a column is missing, a number is not finite.
Result<ExternalTimes> ReadExternalTimes(const std::string& path);

}  // namespace alidade
