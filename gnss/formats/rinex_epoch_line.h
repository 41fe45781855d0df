#pragma once

#include <optional>

#include "core/status.h"
#include "gnss/base/gnss_time.h"
#include "gnss/base/text_file.h"

namespace alidade {

/// An epoch line of any version.
struct EpochLine {
  std::optional<TimeNs> stamp_ns;
  int flag = 0;
  int count = 0;  ///< satellites, or lines of an event
};

/// The epoch that begins in the present line of an observation file; `modern`: RINEX 3 and 4, which mark it
/// by '>'. kInput names the line.
Result<EpochLine> ParseEpochLine(const LineReader& lines, bool modern, TimeScale scale);

}  // namespace alidade
