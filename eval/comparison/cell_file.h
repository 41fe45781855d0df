#pragma once

#include <optional>
#include <string>
#include <vector>

#include "eval/comparison/cell_report.h"

namespace alidade {

/// Writes a report as CBOR: numbers keep every bit. kOutput: cannot be written.
Status WriteCellFile(const CellReport& report, const std::string& path);

/// Reads it again. Errors (kInput): cannot be read; not such a file, or one of another version of the fields.
Result<CellReport> ReadCellFile(const std::string& path);

/// How the cell of a report ended: `status` and `message` of its CellResult alone, several times as fast.
struct CellEnd {
  std::string status, message;
};
Result<CellEnd> ReadCellEnd(const std::string& path);

}  // namespace alidade
