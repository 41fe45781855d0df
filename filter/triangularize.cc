#include "filter/triangularize.h"

#include <cmath>

namespace alidade {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

void FoldColumns(Eigen::Ref<MatrixXd> square, Eigen::Ref<MatrixXd> extra, VectorXd* scratch) {
  const Index size = square.rows();
  const Index width = extra.cols();
  for (Index row = size - 1; row >= 0; --row) {
    const double pivot = square(row, row);
    const double extra_norm2 = extra.row(row).squaredNorm();
    if (extra_norm2 == 0) {
      continue;
    }
    const double norm = std::sqrt(pivot * pivot + extra_norm2);
    const double alpha = pivot > 0 ? -norm : norm;
    const double v0 = pivot - alpha;
    const double scale = -1.0 / (alpha * v0);
    // w = [square.col(row) | extra] v over rows 0..row, then subtract scale w v^T.
    auto w = scratch->head(row + 1);
    w = v0 * square.col(row).head(row + 1);
    for (Index k = 0; k < width; ++k) {
      w += extra(row, k) * extra.col(k).head(row + 1);
    }
    w *= scale;
    square.col(row).head(row + 1) -= v0 * w;
    for (Index k = 0; k < width; ++k) {
      const double v = extra(row, k);
      extra.col(k).head(row + 1) -= v * w;
    }
  }
}

void TriangularizeBottom(Eigen::Ref<MatrixXd> b, Index size, VectorXd* scratch) {
  const Index rows_above = b.rows() - size;
  const Index surplus = b.cols() - size;
  for (Index i = size - 1; i >= 0; --i) {
    const Index row = rows_above + i;
    const Index last = surplus + i;  // the pivot column of this row
    const double rest2 = b.row(row).head(last).squaredNorm();
    if (rest2 == 0) {
      continue;
    }
    const double pivot = b(row, last);
    const double norm = std::sqrt(rest2 + pivot * pivot);
    const double alpha = pivot > 0 ? -norm : norm;
    b(row, last) = pivot - alpha;
    const double scale = -1.0 / (alpha * b(row, last));
    auto w = scratch->head(row);
    w.setZero();
    for (Index column = 0; column <= last; ++column) {
      w += (scale * b(row, column)) * b.col(column).head(row);
    }
    for (Index column = 0; column <= last; ++column) {
      b.col(column).head(row) -= b(row, column) * w;
    }
    b.row(row).head(last).setZero();
    b(row, last) = alpha;
  }
}

}  // namespace alidade
