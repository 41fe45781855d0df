#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/status.h"
#include "eval/trajectory/trajectory.h"

namespace alidade {

/// Path of the covariances of a truth file: `data.csv` has them in `data_covariance.csv` beside it.
[[nodiscard]] std::string CovariancePath(const std::string& truth_path);

/// Reads the covariances beside a truth file, if there are any, into its rows: a row a pose, equal stamps in
/// equal order, `#timestamp [ns]` and the upper triangle c_00..c_55, row by row, of the covariance of (phi,
/// dp) [rad, m] in the canonical chart R = R^ Exp(phi), p = p^ + dp. Errors (kInput): file and line of a torn
/// row, a number that is not finite, a negative variance, a stamp other than that of the pose; rows missing
/// or left over.
Status ReadCovarianceBeside(const std::string& truth_path, Trajectory* truth);

/// The same of a truth with these stamps: the covariance of its row `row` is handed to `take`. False: there
/// are none.
Result<bool> ReadCovarianceBeside(const std::string& truth_path, const std::vector<TimeNs>& stamps,
                                  const std::function<void(size_t row, const Matrix6d& covariance)>& take);

/// The text of that file.
[[nodiscard]] std::string CovarianceCsv(const Trajectory& truth);

}  // namespace alidade
