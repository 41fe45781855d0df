#pragma once

#include <cstdint>
#include <vector>

#include "core/camera_model.h"
#include "eval/render/exposure_control.h"
#include "eval/simulation/render_config.h"
#include "frontend/tracking/image_reader.h"

namespace alidade {

/// Light to grey values: vignetting, gain, noise, rounding.
///
/// With the light e of a pixel, in grey values at gain 1, after vignetting, the grey value is gain * e plus
/// noise of the variance
///
///   (gain read_noise)^2 + gain^2 shot_noise e,
///
/// read noise before the amplifier and photons counted before it (EMVA standard 1288, release 4.0, eq. 11
/// without its quantisation). The noise depends on seed and frame alone.
class ImageSensor {
 public:
  ImageSensor(const CameraModel& camera, const RenderConfig& config, std::uint64_t seed);

  /// sums: row-major sums over the rays of each pixel; scale: light a unit of them.
  [[nodiscard]] GreyImage Expose(const std::vector<float>& sums, double scale, double gain,
                                 std::uint64_t frame) const;

  /// Share of the light that reaches a pixel, row-major: 1 - vignetting (r / r_max)^2 with the distance r
  /// from the principal point and that of the farthest corner r_max. Empty without vignetting.
  [[nodiscard]] const std::vector<float>& vignette() const { return vignette_; }

 private:
  int width_px_;
  int height_px_;
  float read_noise_grey_;
  float shot_noise_grey_;
  std::vector<float> vignette_;
  std::vector<float> normals_;  ///< standard normal numbers to pick from
  std::uint64_t seed_;
};

}  // namespace alidade
