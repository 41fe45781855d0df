#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/status.h"
#include "core/time.h"
#include "eval/files/csv.h"

namespace alidade {

/// A CSV file after its checked header row. Errors (kInput): missing file, empty file, another header.
Result<CsvReader> OpenTable(const std::string& path, const std::vector<CsvColumn>& header);

/// Appends a comma and the shortest text that reads back equal.
void AppendField(double value, std::string* row);
/// The same for each of three columns.
void AppendFields(const Eigen::Vector3d& vector, std::string* row);

/// Mean rate of `count` stamps between the first and the last [Hz]; 0 when there are fewer than two.
[[nodiscard]] double MeasuredRate(TimeNs first, TimeNs last, size_t count);

}  // namespace alidade
