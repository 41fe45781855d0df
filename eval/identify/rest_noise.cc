#include "eval/identify/rest_noise.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "core/format.h"

namespace alidade {
namespace {

/// Least distance between two different values, rounding aside.
double ResolutionOf(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const double rounding = 1e-12 * std::max(std::abs(values.front()), std::abs(values.back()));
  double least = 0;
  for (std::size_t k = 1; k < values.size(); ++k) {
    const double step = values[k] - values[k - 1];
    least = step > rounding && (least == 0 || step < least) ? step : least;
  }
  return least;
}

AxisNoise NoiseOfAxis(const std::vector<double>& rates, std::vector<AllanPoint> curve,
                      const AllanCovariance& covariance) {
  AxisNoise axis;
  axis.curve = std::move(curve);
  axis.fit = FitNoise(axis.curve, covariance);
  axis.resolution = ResolutionOf(rates);
  constexpr double kEnough = 10;
  for (std::size_t i = 0; i < axis.curve.size(); ++i) {
    const double deviation = std::sqrt(axis.curve[i].variance);
    if (axis.fit.dof[i] >= kEnough && (axis.least_tau_s == 0 || deviation < axis.least_deviation)) {
      axis.least_deviation = deviation;
      axis.least_tau_s = axis.curve[i].tau_s;
    }
  }
  return axis;
}

/// Root mean square of one coefficient over the three axes from `first` on; of an invisible one the bound.
double OverAxes(const RestNoise& noise, std::size_t first, NoisePowers::Index index) {
  double square = 0;
  for (std::size_t axis = first; axis < first + 3; ++axis) {
    const NoiseCoefficient& coefficient = noise.axes[axis].fit[index];
    const double value = coefficient.visible ? coefficient.value : coefficient.high;
    square += value * value / 3;
  }
  return std::sqrt(square);
}

void RemarkOnAxis(const AxisNoise& axis, const char* name, double period_s, RestNoise* noise) {
  if (!axis.fit[NoisePowers::kWalk].visible) {
    noise->remarks.push_back(std::string(name) +
                             ": no random walk is visible; the sheet takes its 95 % upper bound");
  }
  const double sample_std = axis.fit[NoisePowers::kWhite].value / std::sqrt(period_s);
  if (axis.resolution > sample_std) {
    noise->remarks.push_back(
        Format("%s: the resolution, %.3g, is coarser than the noise of a sample, %.3g: small "
               "noise is hidden by it",
               name, axis.resolution, sample_std));
  }
}

}  // namespace

Result<RestNoise> IdentifyAtRest(const std::vector<ImuSample>& imu, const InitConfig& init) {
  Result<RestSpan> span = FindRestSpan(imu, init);
  ALIDADE_RETURN_IF_ERROR(span.status());
  RestNoise noise;
  noise.span = *std::move(span);
  noise.remarks = noise.span.remarks;
  std::optional<AllanCovariance> covariance;
  for (std::size_t axis = 0; axis < noise.axes.size(); ++axis) {
    const std::vector<double>& rates = noise.span.axes[axis];
    const auto [least, most] = std::minmax_element(rates.begin(), rates.end());
    if (*least == *most) {
      return Status::Input(Format("imu0: %s is %.9g in all %zu samples at rest, expected noise",
                                  kAxisNames[axis], *least, rates.size()));
    }
    std::vector<AllanPoint> curve = OverlappingAllanVariance(rates, noise.span.period_s);
    if (!covariance) {
      covariance.emplace(curve, rates.size());  // of clusters and samples alone: the same for all axes
    }
    noise.axes[axis] = NoiseOfAxis(rates, std::move(curve), *covariance);
    RemarkOnAxis(noise.axes[axis], kAxisNames[axis], noise.span.period_s, &noise);
  }
  noise.sheet = {OverAxes(noise, 0, NoisePowers::kWhite), OverAxes(noise, 3, NoisePowers::kWhite),
                 OverAxes(noise, 0, NoisePowers::kWalk), OverAxes(noise, 3, NoisePowers::kWalk)};
  return noise;
}

}  // namespace alidade
