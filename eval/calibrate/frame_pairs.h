#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/imu_sample.h"
#include "core/track_frame.h"

namespace alidade {

/// A landmark in both images of a pair, raw pixels.
struct PairView {
  Eigen::Vector2d pixel_i = Eigen::Vector2d::Zero();
  Eigen::Vector2d pixel_j = Eigen::Vector2d::Zero();
};

/// Two frames that share tracks; stamps of the camera's clock, seconds since the first IMU sample.
struct FramePair {
  double t_i_s = 0;
  double t_j_s = 0;
  std::vector<PairView> views;
};

struct FramePairOptions {
  /// Median motion of the tracks that ends a pair. Two views of noise s and motion d determine the geometry
  /// with a bias of order (s / d)^2, which more pairs do not lower.
  double least_flow_px = 60;
  double longest_s = 2;  ///< between its frames
  std::size_t least_views = 15;
  double longest_gap_s = 0.05;  ///< of the IMU inside it
  double margin_s = 0.3;        ///< of IMU data before and after it, for the search of the time offset
};

/// Consecutive pairs along a recording, each from one frame to the first later one by which its tracks have
/// moved far enough, or to the last that shares enough tracks if they have moved a third as far. Frames
/// without such a partner, as at rest, begin none.
[[nodiscard]] std::vector<FramePair> ChooseFramePairs(const std::vector<TrackFrame>& frames,
                                                      const std::vector<ImuSample>& imu,
                                                      const FramePairOptions& options);

}  // namespace alidade
