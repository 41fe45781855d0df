#pragma once

#include <string>
#include <vector>

namespace alidade {

/// A field of a CSV file, quoted where RFC 4180 requires it.
[[nodiscard]] std::string CsvText(const std::string& text);
/// The shortest text that reads back equal; empty where there is no value (not finite).
[[nodiscard]] std::string CsvNumber(double value);
/// A row with its line break.
[[nodiscard]] std::string JoinCsv(const std::vector<std::string>& fields);

}  // namespace alidade
