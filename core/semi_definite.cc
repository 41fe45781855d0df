#include "core/semi_definite.h"

#include <cmath>

namespace alidade {

bool SemiDefiniteCholesky(const Matrix15d& matrix, Matrix15d* lower) {
  lower->setZero();
  for (int j = 0; j < 15; ++j) {
    const double pivot = matrix(j, j) - lower->row(j).head(j).squaredNorm();
    const double rounding = 1e-13 * std::abs(matrix(j, j));
    if (!std::isfinite(pivot) || pivot < -1e-6 * std::abs(matrix(j, j)) - 1e-300) {
      return false;
    }
    if (pivot <= rounding) {
      continue;
    }
    const double root = std::sqrt(pivot);
    (*lower)(j, j) = root;
    for (int i = j + 1; i < 15; ++i) {
      (*lower)(i, j) = (matrix(i, j) - lower->row(i).head(j).dot(lower->row(j).head(j))) / root;
    }
  }
  return true;
}

}  // namespace alidade
