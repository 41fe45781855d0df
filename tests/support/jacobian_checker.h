#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>

#include "core/error_convention.h"

// The one Jacobian checker: every model of the library goes through it, in all three error conventions.

namespace alidade::test {

/// d f / d xi at 0 by central differences, Richardson-extrapolated (error of order step^4). f: xi -> vector.
template <typename Function>
Eigen::MatrixXd NumericJacobian(const Function& f, int tangent_size, double step = 1e-4) {
  const auto difference = [&](int column, double h) -> Eigen::VectorXd {
    Eigen::VectorXd xi = Eigen::VectorXd::Zero(tangent_size);
    xi[column] = h;
    const Eigen::VectorXd plus = f(xi);
    xi[column] = -h;
    const Eigen::VectorXd minus = f(xi);
    return (plus - minus) / (2 * h);
  };
  Eigen::MatrixXd jacobian;
  for (int column = 0; column < tangent_size; ++column) {
    const Eigen::VectorXd coarse = difference(column, step);
    const Eigen::VectorXd fine = difference(column, 0.5 * step);
    if (jacobian.size() == 0) {
      jacobian.resize(coarse.size(), tangent_size);
    }
    jacobian.col(column) = (4 * fine - coarse) / 3;
  }
  return jacobian;
}

/// Empty when the matrices agree to `tolerance` relative to their largest entry, else a message naming the
/// worst entry.
inline std::string CompareJacobians(const Eigen::MatrixXd& analytic, const Eigen::MatrixXd& numeric,
                                    double tolerance) {
  std::ostringstream message;
  if (analytic.rows() != numeric.rows() || analytic.cols() != numeric.cols()) {
    message << "shapes differ: " << analytic.rows() << "x" << analytic.cols() << " against " << numeric.rows()
            << "x" << numeric.cols();
    return message.str();
  }
  if (!analytic.allFinite()) {
    return "analytic Jacobian is not finite";
  }
  Eigen::Index row = 0;
  Eigen::Index col = 0;
  const double worst = (analytic - numeric).cwiseAbs().maxCoeff(&row, &col);
  const double scale = std::max(1.0, numeric.cwiseAbs().maxCoeff());
  if (worst <= tolerance * scale) {
    return "";
  }
  message << "entry (" << row << ", " << col << "): analytic " << analytic(row, col) << ", numeric "
          << numeric(row, col) << ", difference " << worst << " exceeds " << tolerance * scale;
  return message.str();
}

inline constexpr auto kAllConventions = kErrorConventions;

}  // namespace alidade::test
