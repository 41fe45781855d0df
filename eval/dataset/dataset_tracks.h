#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/status.h"
#include "core/track_frame.h"
#include "eval/dataset/log_tables.h"

namespace alidade {

/// tracks.csv, grouped by stamp, each frame sorted by track id. Errors (kInput): torn rows, stamps out of
/// order, a track twice in a frame, no row.
Result<std::vector<TrackFrame>> ReadTracks(const std::string& path);

/// The same into a table of files (Table::InFile).
Status ReadTracks(const std::string& path, Table<TrackFrame>* frames);

/// tracks.csv has no rows of a frame that saw nothing; timestamps.csv beside it has its stamp. All frames,
/// with those of `tracks` where they saw something, are handed to `take`. kInput: a frame of `tracks` that is
/// not in `stamps`.
Status AddEmptyFrames(const std::string& tracks_path, const std::vector<TimeNs>& stamps,
                      const Table<TrackFrame>& tracks, const std::function<Status(const TrackFrame&)>& take);

/// Writes tracks.csv; a frame that saw nothing leaves no row.
Status WriteTracks(const std::vector<TrackFrame>& tracks, const std::string& csv_path);

}  // namespace alidade
