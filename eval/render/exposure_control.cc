#include "eval/render/exposure_control.h"

#include <algorithm>
#include <cmath>

namespace alidade {
namespace {

Exposure Split(const RenderConfig& config, double product) {
  const double least_s = kLeastExposureShare * config.exposure_s;
  Exposure exposure;
  exposure.time_s = std::clamp(product * config.exposure_s, least_s, config.exposure_max_s);
  exposure.gain = std::clamp(product * config.exposure_s / exposure.time_s, 1.0, config.gain_max);
  return exposure;
}

}  // namespace

std::vector<Exposure> ControlExposure(const RenderConfig& config, const std::vector<double>& scene_grey) {
  const double least = kLeastExposureShare;
  const double most = config.exposure_max_s / config.exposure_s * config.gain_max;
  const auto wanted = [&](std::size_t i) {
    return scene_grey[i] > 0 ? config.exposure_target_grey / scene_grey[i] : most;
  };
  const auto delay = static_cast<std::size_t>(config.exposure_delay_frames);
  std::vector<double> products;
  std::vector<Exposure> exposures;
  for (std::size_t i = 0; i < scene_grey.size(); ++i) {
    double product = i == 0 ? wanted(0) : products[i - 1];
    if (i >= delay) {
      const double error = wanted(i - delay) / products[i - delay];
      if (std::abs(error - 1) > config.exposure_band) {
        product *= std::pow(error, config.exposure_rate);
      }
    }
    products.push_back(std::clamp(product, least, most));
    exposures.push_back(Split(config, products.back()));
  }
  return exposures;
}

}  // namespace alidade
