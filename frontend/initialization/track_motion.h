#pragma once

#include "core/track_frame.h"

namespace alidade {

/// How far the image moved between two frames.
struct TrackMotion {
  int common = 0;      ///< tracks seen in both frames
  int candidates = 0;  ///< tracks of the frame that has fewer
  double motion_px =
      0;  ///< mean length of the fitted flow at the common tracks; 0 with fewer than three of them
};

/// Fits an affine flow field to the tracks common to both frames (least squares, outliers trimmed twice) and
/// averages its length over them. Fitting averages the pixel noise away, which the mean length of raw
/// displacements would add up: at rest the answer is about sigma sqrt(12 / common) px. Observations must be
/// sorted by track id.
[[nodiscard]] TrackMotion MeasureTrackMotion(const TrackFrame& from, const TrackFrame& to);

}  // namespace alidade
