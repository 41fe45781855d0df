#pragma once

#include <vector>

#include "eval/simulation/render_config.h"

namespace alidade {

/// How one image is exposed.
struct Exposure {
  double time_s = 0;
  double gain = 1;
};

/// The exposure of each image under automatic control. scene_grey: the mean grey that each image would have
/// with exposure_s and gain 1, not clipped.
///
/// With the product p of exposure time (over exposure_s) and gain, image i has the mean grey scene_i p_i. The
/// control reads it exposure_delay_frames later and corrects a share of its error,
///
///   log p_i = log p_(i-1) + exposure_rate log(exposure_target_grey / (scene_j p_j)),  j = i - delay,
///
/// unless the relative error is within exposure_band. The time takes p up first, so that there is as little
/// noise as the allowed motion blur permits, then the gain. The first image is exposed as if the control had
/// settled on it.
[[nodiscard]] std::vector<Exposure> ControlExposure(const RenderConfig& config,
                                                    const std::vector<double>& scene_grey);

/// Shortest exposure time of the control, a share of exposure_s.
inline constexpr double kLeastExposureShare = 0.1;

}  // namespace alidade
