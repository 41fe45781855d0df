#pragma once

#include <vector>

#include "eval/dataset/dataset.h"

namespace alidade::cli {

/// `track --score`: scores tracks of a sequence against its truth and the hall of its renderer, as far as it
/// has them; writes score.json and score.csv into --output and prints the score. cpu_ms: of the tracker, one
/// a frame, or none.
Status ReportTrackScore(const Dataset& dataset, const std::vector<TrackFrame>& tracks,
                        const std::vector<double>& cpu_ms);

}  // namespace alidade::cli
