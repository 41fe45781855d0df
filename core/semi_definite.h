#pragma once

#include "core/lie.h"

namespace alidade {

/// Lower factor L of a symmetric positive semi-definite matrix, M = L L^T; pivots below rounding give zero
/// columns. False when a pivot is clearly negative or not finite.
[[nodiscard]] bool SemiDefiniteCholesky(const Matrix15d& matrix, Matrix15d* lower);

}  // namespace alidade
