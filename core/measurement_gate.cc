#include "core/measurement_gate.h"

#include <cmath>

namespace alidade {

MeasurementGate::MeasurementGate(int rows, double probability, int max_refused_run,
                                 const ObservationKernel& kernel)
    : threshold_(ChiSquareQuantile(rows, probability)), max_refused_run_(max_refused_run), kernel_(kernel) {}

double MeasurementGate::Weigh(double nis) {
  if (nis <= threshold_) {
    refused_in_a_row_ = 0;
    return kernel_.Weight(nis);
  }
  ++refused_in_a_row_;
  return refused_in_a_row_ > max_refused_run_ && std::isfinite(nis) ? threshold_ / nis : 0;
}

}  // namespace alidade
