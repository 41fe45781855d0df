#pragma once

#include <chrono>
#include <string>

#include "core/status.h"

namespace alidade {

/// The day in UTC, "2026-11-25". `source_date_epoch`, unless null or empty: the time instead of `now`, in
/// seconds since 1970 (https://reproducible-builds.org/specs/source-date-epoch). kUsage: it is not a whole
/// number from 0 to the end of the year 9999.
Result<std::string> UtcDay(const char* source_date_epoch, std::chrono::system_clock::time_point now);

/// That of the environment's SOURCE_DATE_EPOCH, else of now.
Result<std::string> UtcDay();

}  // namespace alidade
