#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "core/camera_model.h"
#include "core/track_frame.h"
#include "eval/peers/vins_feature.h"

namespace alidade {

/// Features of a sequence's tracks: those seen in the frame before, too, with their velocity since then.
/// Observations outside the lens model are left out.
class GivenFeatures {
 public:
  std::vector<VinsFeature> Take(const CameraModel& camera, const TrackFrame& frame, double time_s);

 private:
  struct Seen {
    double time_s;
    Eigen::Vector2d plane;
  };
  std::map<std::int64_t, Seen> seen_;  ///< in the last frame
};

}  // namespace alidade
