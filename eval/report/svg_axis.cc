#include "eval/report/svg_axis.h"

#include <algorithm>
#include <cmath>

namespace alidade {
namespace {

/// A point far outside is as good as one just outside, and renderers cannot place it.
constexpr double kFarOutside = 1e4;

std::vector<double> LogTicks(double low, double high) {
  std::vector<double> decades, all;
  for (int e = static_cast<int>(std::floor(std::log10(low))); e <= std::ceil(std::log10(high)); ++e) {
    for (const double mantissa : {1.0, 2.0, 5.0}) {
      const double value = mantissa * std::pow(10.0, e);
      if (value >= low * 0.999 && value <= high * 1.001) {
        all.push_back(value);
        if (mantissa == 1.0) {
          decades.push_back(value);
        }
      }
    }
  }
  if (all.size() <= 7 || decades.size() < 2) {
    return all;
  }
  const size_t every = (decades.size() + 6) / 7;
  std::vector<double> ticks;
  for (size_t i = 0; i < decades.size(); i += every) {
    ticks.push_back(decades[i]);
  }
  return ticks;
}

}  // namespace

SvgAxis::SvgAxis(double low, double high, double from, double to, bool log)
    : low_(low), high_(high), from_(from), to_(to), log_(log) {}

double SvgAxis::At(double value) const {
  const double share =
      log_ ? std::log(value / low_) / std::log(high_ / low_) : (value - low_) / (high_ - low_);
  return std::clamp(from_ + share * (to_ - from_), -kFarOutside, kFarOutside);
}

std::vector<double> SvgAxis::Ticks(int count) const {
  if (log_) {
    return LogTicks(low_, high_);
  }
  const double rough = (high_ - low_) / count;
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  double step = 10 * power;
  for (const double mantissa : {5.0, 2.0, 1.0}) {
    step = mantissa * power >= rough ? mantissa * power : step;
  }
  std::vector<double> ticks;
  for (double k = std::ceil(low_ / step - 1e-9); k * step <= high_ + 1e-9 * step; ++k) {
    ticks.push_back(k == 0 ? 0 : k * step);  // no "-0"
  }
  return ticks;
}

}  // namespace alidade
