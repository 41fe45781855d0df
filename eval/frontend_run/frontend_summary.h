#pragma once

#include <string>
#include <vector>

#include "core/track_frame.h"
#include "frontend/tracking/klt_tracker.h"

namespace alidade {

/// How a front end did on the images of one sequence.
struct FrontendSummary {
  std::string sequence;
  unsigned seed = 0;
  int images = 0;
  int tracks = 0;                 ///< ever
  double features_per_frame = 0;  ///< mean
  double median_length = 0;       ///< frames that a track lived, median over the tracks
  double mean_length = 0;
  double lost_share =
      0;  ///< of the tracks of a frame, mean: followed no further, out of view, unlike their first image
  double rejected_share = 0;       ///< likewise: refused by the epipolar geometry, the outliers
  double thinned_share = 0;        ///< likewise: crowded a longer track
  double mean_ms = 0, p95_ms = 0;  ///< front end a frame, wall time
};

/// frames and statistics: one an image. Shares are NaN without statistics.
[[nodiscard]] FrontendSummary SummarizeFrontend(const std::vector<TrackFrame>& frames,
                                                const std::vector<TrackerStatistics>& statistics);

/// One row an image: timestamp_ns,features,tracked,lost,rejected,thinned,detected,mean_track_length. Equal
/// input, equal bytes: no times.
[[nodiscard]] std::string FrontendCsv(const std::vector<TrackFrame>& frames,
                                      const std::vector<TrackerStatistics>& statistics);

}  // namespace alidade
