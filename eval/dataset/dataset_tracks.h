#pragma once

#include <string>
#include <vector>

#include "core/status.h"
#include "core/track_frame.h"

namespace alidade {

/// tracks.csv, grouped by stamp, each frame sorted by track id. Errors (kInput): torn rows, stamps out of
/// order, a track twice in a frame, no row.
Result<std::vector<TrackFrame>> ReadTracks(const std::string& path);

/// Writes tracks.csv; a frame that saw nothing leaves no row.
Status WriteTracks(const std::vector<TrackFrame>& tracks, const std::string& csv_path);

}  // namespace alidade
