#include "core/robust.h"

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <limits>

#include "core/check.h"

namespace alidade {

double ChiSquareQuantile(int dof, double probability) {
  CHECK_GT(dof, 0);
  if (probability >= 1) {
    return std::numeric_limits<double>::infinity();
  }
  return boost::math::quantile(boost::math::chi_squared(dof), probability);
}

ChiSquareGate::ChiSquareGate(double probability, int max_dof) : probability_(probability) {
  thresholds_.reserve(static_cast<size_t>(max_dof));
  for (int dof = 1; dof <= max_dof; ++dof) {
    thresholds_.push_back(ChiSquareQuantile(dof, probability));
  }
}

double ChiSquareGate::Threshold(int dof) const {
  CHECK_GT(dof, 0);
  return dof <= static_cast<int>(thresholds_.size()) ? thresholds_[static_cast<size_t>(dof - 1)]
                                                     : ChiSquareQuantile(dof, probability_);
}

bool ChiSquareGate::Accepts(double nis, int dof) const {
  return nis <= Threshold(dof);
}

double RobustCost(RobustKernel kernel, double scale_sigma, double squared_norm) {
  const double k2 = scale_sigma * scale_sigma;
  switch (kernel) {
    case RobustKernel::kHuber:
      return squared_norm <= k2 ? squared_norm : 2 * scale_sigma * std::sqrt(squared_norm) - k2;
    case RobustKernel::kCauchy:
      return k2 * std::log1p(squared_norm / k2);
    case RobustKernel::kLogTail:
      return squared_norm <= k2 ? squared_norm : k2 * (1 + std::log(squared_norm / k2));
    case RobustKernel::kNone:
      break;
  }
  return squared_norm;
}

double RobustWeight(RobustKernel kernel, double scale_sigma, double squared_norm) {
  switch (kernel) {
    case RobustKernel::kHuber:
      return std::min(1.0, scale_sigma / std::sqrt(std::max(squared_norm, 1e-300)));
    case RobustKernel::kCauchy:
      return 1.0 / (1.0 + squared_norm / (scale_sigma * scale_sigma));
    case RobustKernel::kLogTail:
      return std::min(1.0, scale_sigma * scale_sigma / std::max(squared_norm, 1e-300));
    case RobustKernel::kNone:
      break;
  }
  return 1.0;
}

double ObservationKernel::SecondDerivative(double s) const {
  const double k2 = scale_sigma * scale_sigma;
  const double weight = Weight(s);
  switch (kernel) {
    case RobustKernel::kHuber:
      return s > k2 ? -weight / (2 * s) : 0;
    case RobustKernel::kCauchy:
      return -weight * weight / k2;
    case RobustKernel::kLogTail:
      return s > k2 ? -weight / s : 0;
    case RobustKernel::kNone:
      break;
  }
  return 0;
}

double ObservationKernel::RadialCurvature(double s) const {
  const double k2 = scale_sigma * scale_sigma;
  switch (kernel) {
    case RobustKernel::kHuber:
      return s > k2 ? 0 : 1;
    case RobustKernel::kCauchy:
      return Weight(s) * ((k2 - s) / (k2 + s));
    case RobustKernel::kLogTail:
      return s > k2 ? -Weight(s) : 1;
    case RobustKernel::kNone:
      break;
  }
  return 1;
}

RobustResidual Robustify(RobustKernel kernel, double scale_sigma, double residual) {
  const double k = scale_sigma;
  const double size = std::abs(residual);
  const double sign = residual < 0 ? -1 : 1;
  switch (kernel) {
    case RobustKernel::kHuber: {
      if (size <= k) {
        break;
      }
      const double root = std::sqrt(2 * k * size - k * k);
      return {sign * root, k / root};
    }
    case RobustKernel::kCauchy: {
      const double ratio = size / k;
      constexpr double kQuadratic = 1e-4;  // below, rho = r^2 to 1e-8 and the slope is 0 / 0 at zero
      if (ratio < kQuadratic) {
        break;
      }
      const double root = k * std::sqrt(std::log1p(ratio * ratio));
      return {sign * root, size / ((1 + ratio * ratio) * root)};
    }
    case RobustKernel::kLogTail: {
      if (size <= k) {
        break;
      }
      const double root = k * std::sqrt(1 + 2 * std::log(size / k));
      return {sign * root, k * k / (size * root)};
    }
    case RobustKernel::kNone:
      break;
  }
  return {residual, 1};
}

bool StateIsSuspect(int refused, int total, double max_refused_share, int least_refused) {
  return refused >= least_refused && refused > max_refused_share * static_cast<double>(total);
}

}  // namespace alidade
