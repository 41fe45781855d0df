#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/imu_sample.h"
#include "core/track_frame.h"
#include "eval/dataset/log_tables.h"

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
/// without such a partner, as at rest, begin none. Of more than `most` pairs, that many, spread evenly.
[[nodiscard]] std::vector<FramePair> ChooseFramePairs(const LogTables& tables,
                                                      const FramePairOptions& options, std::size_t most);

/// The samples within `margin_s` of the pairs, the first two, whose first is the origin of their time, and
/// the last.
[[nodiscard]] std::vector<ImuSample> SamplesAround(const std::vector<FramePair>& pairs,
                                                   const Table<ImuSample>& imu, double margin_s);

}  // namespace alidade
