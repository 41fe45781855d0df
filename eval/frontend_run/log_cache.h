#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/track_frame.h"
#include "frontend/tracking/klt_tracker.h"

namespace alidade {

/// What a front end made of the images of one sequence.
struct FrontendRun {
  std::vector<TrackFrame> frames;
  std::vector<TrackerStatistics> statistics;  ///< one a frame
};

/// Keeps a run of the front end in `folder`: tracks.csv, frontend.csv (eval/frontend_run/frontend_summary.h),
/// its times in timing.csv and, last, log.txt with the digests of `source` (whatever determines the run) and
/// of the first two. kOutput: cannot be written.
Status WriteFrontendRun(const FrontendRun& run, const std::string& source, const std::string& folder);

/// The run kept there, to the last bit; none when it is missing, torn, changed or of another source.
[[nodiscard]] std::optional<FrontendRun> ReadFrontendRun(const std::string& source,
                                                         const std::string& folder);

}  // namespace alidade
