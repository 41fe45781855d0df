#include "core/pixel_noise.h"

#include <algorithm>
#include <cmath>

namespace alidade {
namespace {

constexpr double kWindowSeconds = 20;
constexpr double kMaxRate = 0.01;      // of the logarithm of the deviation, 1/s
constexpr double kMaxStepSeconds = 1;  // a longer silence counts as this
constexpr int kMinRows = 10;

}  // namespace

PixelNoise::PixelNoise(const VisionConfig& config)
    : given_px_(config.pixel_noise_px),
      adaptive_(config.noise == PixelNoiseModel::kAdaptive),
      ratios_(config.noise_ratios) {}

void PixelNoise::Reset() {
  scale_ = mean_ = 1;
  nis_ = dof_ = 0;
  last_ns_ = INT64_MIN;
}

void PixelNoise::AddTrack(double nis, int dof) {
  nis_ += nis;
  dof_ += dof;
}

void PixelNoise::EndFrame(TimeNs stamp_ns, bool suspect) {
  if (adaptive_ && last_ns_ != INT64_MIN && stamp_ns > last_ns_ && !suspect && dof_ >= kMinRows) {
    const double duration_s = std::min(SecondsBetween(last_ns_, stamp_ns), kMaxStepSeconds);
    const double variance = scale_ * scale_ * nis_ / dof_;
    mean_ += (1 - std::exp(-duration_s / kWindowSeconds)) * (variance - mean_);
    const double wanted = 0.5 * std::log(std::max(1.0, mean_) / (scale_ * scale_));
    scale_ *= std::exp(std::clamp(wanted, -kMaxRate * duration_s, kMaxRate * duration_s));
  }
  nis_ = 0;
  dof_ = 0;
  last_ns_ = stamp_ns;
}

}  // namespace alidade
