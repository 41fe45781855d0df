#pragma once

#include <vector>

#include "eval/dataset/dataset.h"
#include "eval/frontend_run/track_score.h"

namespace alidade {

/// What tracks of a sequence are scored against: of a rendered one the poses and surfaces that were drawn
/// (eval/render/hall_file.h), with the time of each row by the sheet's line delay; else the truth, if it has
/// orientations. Errors: those of the files.
Result<TrackTruth> TruthOfTracks(const Dataset& dataset, const std::vector<TrackFrame>& tracks);

}  // namespace alidade
