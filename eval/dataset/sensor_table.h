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

/// What is expected of a clock's offset from the IMU's, `time_offset_s` of a receiver's sheet.
inline constexpr const char* kClockOffsetExpected = "a number within +-4.6e9 s";
static_assert(kMaxClockOffsetS == 4.6e9);
/// kInput where a stamp of a sensor is none of the IMU's clock with its sheet's offset.
[[nodiscard]] Status CheckStampWithOffset(const std::string& sheet, TimeNs stamp_ns, double offset_s);

/// Mean rate of `count` stamps between the first and the last [Hz]; 0 when there are fewer than two.
[[nodiscard]] double MeasuredRate(TimeNs first, TimeNs last, size_t count);

}  // namespace alidade
