#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "eval/simulation/render_config.h"

namespace alidade {

/// Light of the hall beyond the shade of each face.
class HallLight {
 public:
  HallLight(const RenderConfig& config, std::uint64_t seed);

  /// Factor on the grey of a surface at `place` (coordinates of the hall): light_contrast to the power of
  /// sin(2 pi x / L + a) sin(2 pi y / L + b) / 2 with L = kWavelengthM. So the brightest place is that many
  /// times brighter than the darkest one.
  [[nodiscard]] float At(const Eigen::Vector3f& place) const;
  [[nodiscard]] bool is_even() const { return log2_contrast_ == 0; }

  /// Whether a place of the ceiling is part of a lamp: a square of kLampSideM every lamp_spacing_m.
  [[nodiscard]] bool IsLamp(const Eigen::Vector3f& place) const;

  /// All lights at `time_s`: less light_step in every second light_step_period_s.
  [[nodiscard]] double StepAt(double time_s) const;

  static constexpr float kWavelengthM = 9;
  static constexpr float kLampSideM = 0.5F;
  /// Eight times what saturates the image.
  static constexpr float kLampGrey = 2040;

 private:
  float log2_contrast_;
  float lamp_spacing_m_;
  double step_;
  double step_period_s_;
  Eigen::Vector2f phase_;
};

}  // namespace alidade
