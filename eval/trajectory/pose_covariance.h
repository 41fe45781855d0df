#pragma once

#include <array>
#include <string_view>

#include "core/lie.h"
#include "eval/files/csv.h"

namespace alidade {

/// Names of the 21 columns of the upper triangle of a pose's covariance, row by row: c_00, c_01, ..., c_55.
[[nodiscard]] const std::array<std::string_view, 21>& PoseCovarianceNames();

/// Reads them from columns first .. first + 20. Errors (kInput): a number that is not finite, a negative
/// variance.
Status ReadPoseCovariance(const CsvReader& csv, size_t first, Matrix6d* covariance);

}  // namespace alidade
