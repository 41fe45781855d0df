#include "core/gate_noise.h"

#include <algorithm>
#include <cmath>

namespace alidade {
namespace {

constexpr size_t kLeastTracks = 20;
constexpr size_t kMostTracks = 4096;  // kept between two estimates
constexpr double kWindowSeconds = 2;
constexpr double kMaxStepSeconds = 1;  // a longer silence counts as this
constexpr double kMargin = 1.25;       // on the deviation
constexpr double kLeastPx = 0.05;      // what interpolation and lens model leave

/// Median of the chi-square distribution (Wilson and Hilferty).
double ChiSquareMedian(int dof) {
  const double root = 1 - 2 / (9.0 * dof);
  return dof * root * root * root;
}

}  // namespace

GateNoise::GateNoise(const VisionConfig& config)
    : adaptive_(config.gate_noise == GateNoiseModel::kAdaptive),
      least_(std::min(1.0, kLeastPx / config.pixel_noise_px)) {
  ratios_.reserve(adaptive_ ? kMostTracks : 0);
}

void GateNoise::Reset() {
  log_estimate_ = 0;
  variance_ = 1;
  ratios_.clear();
  last_ns_ = INT64_MIN;
}

void GateNoise::AddTrack(double nis, int dof) {
  if (adaptive_ && std::isfinite(nis) && ratios_.size() < kMostTracks) {
    ratios_.push_back(nis / ChiSquareMedian(dof));
  }
}

void GateNoise::EndFrame(TimeNs stamp_ns) {
  if (last_ns_ == INT64_MIN || stamp_ns <= last_ns_) {
    last_ns_ = stamp_ns;
    return;
  }
  if (ratios_.size() < kLeastTracks) {
    return;
  }
  const auto middle = ratios_.begin() + static_cast<std::ptrdiff_t>(ratios_.size() / 2);
  std::nth_element(ratios_.begin(), middle, ratios_.end());
  const double step_s = std::min(SecondsBetween(last_ns_, stamp_ns), kMaxStepSeconds);
  const double shown = std::log(std::max(variance_ * *middle, least_ * least_));
  log_estimate_ += (1 - std::exp(-step_s / kWindowSeconds)) * (shown - log_estimate_);
  variance_ = std::min(1.0, kMargin * kMargin * std::exp(log_estimate_));
  ratios_.clear();
  last_ns_ = stamp_ns;
}

}  // namespace alidade
