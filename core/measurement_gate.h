#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "core/lie.h"
#include "core/robust.h"

namespace alidade {

/// Gate and kernel of one sensor's measurements in their order of time, shared by the back ends.
///
/// A measurement inside the gate has its kernel's weight; one outside has none. When more than
/// max_refused_run of them are refused in a row, the state is suspect and not the measurements: they are
/// used, scaled down to the gate, until one is inside again.
class MeasurementGate {
 public:
  /// `rows`: of a measurement. `probability`: of the chi-square quantile; 1 opens the gate.
  MeasurementGate(int rows, double probability, int max_refused_run, const ObservationKernel& kernel);

  /// The weight of a measurement's information, in [0, 1]; 0: refused. `nis`: normalised innovation squared.
  double Weigh(double nis);
  void Reset() { refused_in_a_row_ = 0; }

 private:
  double threshold_;
  int max_refused_run_;
  ObservationKernel kernel_;
  int refused_in_a_row_ = 0;
};

/// Normalised innovation squared of a whitened residual and its Jacobian over the errors that `covariance` is
/// of.
template <int kRows>
[[nodiscard]] double InnovationNis(const Eigen::Matrix<double, kRows, 1>& residual,
                                   const Eigen::Matrix<double, kRows, 15>& jacobian,
                                   const Matrix15d& covariance) {
  using Square = Eigen::Matrix<double, kRows, kRows>;
  const Square innovation_covariance = jacobian * covariance * jacobian.transpose() + Square::Identity();
  return residual.dot(innovation_covariance.llt().solve(residual));
}

}  // namespace alidade
