#pragma once

#include <string>

#include "eval/files/csv.h"
#include "eval/record/run_result.h"

namespace alidade {

/// covariance.csv of a run: one row a frame with the upper triangles xx xy xz yy yz zz of the covariances of
/// velocity [m/s], gyroscope bias [rad/s] and accelerometer bias [m/s^2].
[[nodiscard]] std::string MotionCovarianceHeader();
void AppendMotionCovariance(const RunRecord& record, std::string* text);

/// Columns of that file, the stamp's included.
inline constexpr size_t kMotionCovarianceColumns = 19;

/// Reads a row of it into the record's covariance. Errors: those of CsvReader::ReadReal.
Status ReadMotionCovarianceRow(const CsvReader& row, RunRecord* record);

}  // namespace alidade
