#include "eval/render/hall_light.h"

#include <cmath>
#include <numbers>

#include "core/random.h"

namespace alidade {

HallLight::HallLight(const RenderConfig& config, std::uint64_t seed)
    : log2_contrast_(static_cast<float>(std::log2(config.light_contrast))),
      lamp_spacing_m_(static_cast<float>(config.lamp_spacing_m)),
      step_(config.light_step),
      step_period_s_(config.light_step_period_s) {
  RandomStream stream(seed, "render.light");
  const double x = stream.Uniform(0, 2 * std::numbers::pi);
  const double y = stream.Uniform(0, 2 * std::numbers::pi);
  phase_ = Eigen::Vector2d(x, y).cast<float>();
}

float HallLight::At(const Eigen::Vector3f& place) const {
  constexpr float kWaveNumber = 2 * std::numbers::pi_v<float> / kWavelengthM;
  const float wave =
      std::sin(kWaveNumber * place.x() + phase_.x()) * std::sin(kWaveNumber * place.y() + phase_.y());
  return std::exp2(0.5F * log2_contrast_ * wave);
}

bool HallLight::IsLamp(const Eigen::Vector3f& place) const {
  if (lamp_spacing_m_ <= 0) {
    return false;
  }
  const auto off = [this](float at) {
    return std::abs(at - lamp_spacing_m_ * std::round(at / lamp_spacing_m_));
  };
  return std::max(off(place.x()), off(place.y())) < 0.5F * kLampSideM;
}

double HallLight::StepAt(double time_s) const {
  const auto periods = static_cast<std::int64_t>(std::floor(time_s / step_period_s_));
  return periods % 2 == 0 ? 1 : 1 - step_;
}

}  // namespace alidade
