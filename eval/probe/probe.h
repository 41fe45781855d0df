#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/error_convention.h"
#include "core/status.h"

namespace alidade {

/// Names that Probe accepts, in the order of the documentation.
[[nodiscard]] const std::vector<std::string>& ProbeModels();

/// Evaluates one measurement model on given cases, so that others can compare it with theirs number by
/// number.
///
/// `input` is {"cases": [...]}, the answer {"cases": [...]} in the same order; matrices are arrays of rows,
/// rotations unit Hamilton quaternions w x y z, stamps integer nanoseconds, units SI, image coordinates on
/// the ideal normalised plane. Jacobians and covariances are in the error coordinates of `convention`:
/// (theta, p) per view, (theta, p, v, bg, ba) for the IMU. Residuals are observed - predicted, Jacobians d
/// predicted / d error.
///
/// A case that cannot be evaluated answers {"error": "..."} in its place. Errors: kUsage for an unknown
/// model, kInput when `input` is not JSON or has no array `cases`.
Result<std::string> Probe(std::string_view model, const std::string& input, ErrorConvention convention);

}  // namespace alidade
