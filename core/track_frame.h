#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/time.h"

namespace alidade {

/// One tracked feature in one frame. Ids are unique in a log. A track may pause, when frames between are not
/// used (eval/run/degradation.h), and then goes on under its id.
struct TrackObservation {
  std::int64_t track_id = 0;
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();  ///< raw (distorted) image coordinates [px]
  /// Standard deviation of either coordinate, divided by vision.pixel_noise_px.
  double noise_ratio = 1;
};

/// All observations of one camera image, sorted by track id.
struct TrackFrame {
  TimeNs stamp_ns = 0;
  std::vector<TrackObservation> observations;
  /// Wall time the front end spent on this frame; 0 when the tracks were read from a file.
  double frontend_ms = 0;
  /// The image is the one before under a new stamp: without observations, but no track has ended.
  bool repeated = false;
};

}  // namespace alidade
