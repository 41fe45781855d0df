#pragma once

#include <string>
#include <vector>

#include "core/status.h"
#include "eval/dataset/dataset.h"

namespace alidade {

class Findings;
class LogHasher;

/// What a sequence has of one sensor, or its truth. Null: this part has nothing to do there.
struct DatasetPart {
  /// Reads the part's folders below `mav` into the dataset. Ok without them, unless every sequence has them.
  Status (*read)(const std::string& mav, const DatasetStorage& storage, Dataset* dataset);
  /// Writes the part's folders below `mav`, and removes those of another sequence (stale_parts.h).
  Status (*write)(const Dataset& dataset, const std::string& mav);
  /// Adds the part to the digest of a log with these long tables; nothing when the log has none of it.
  /// Errors: the tables'.
  Status (*digest)(const MeasurementLog& log, const LogTables& tables, LogHasher* hasher);
  /// The findings of `check` about it.
  void (*check)(const Dataset& dataset, Findings* findings);
};

/// All parts, in the order in which they are read, written, digested and checked; the IMU is the first.
[[nodiscard]] const std::vector<DatasetPart>& DatasetParts();

}  // namespace alidade
