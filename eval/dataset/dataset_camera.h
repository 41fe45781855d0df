#pragma once

#include <string>
#include <vector>

#include "eval/dataset/dataset.h"
#include "eval/files/csv.h"

namespace alidade {

/// A CSV file after its checked header row. Errors (kInput): missing file, empty file, another header.
Result<CsvReader> OpenTable(const std::string& path, const std::vector<CsvColumn>& header);

/// Mean rate of `count` stamps between the first and the last [Hz]; 0 when there are fewer than two.
[[nodiscard]] double MeasuredRate(TimeNs first, TimeNs last, size_t count);

/// tracks.csv, grouped by stamp, each frame sorted by track id. Errors (kInput): torn rows, stamps out of
/// order, a track twice in a frame, no row.
Result<std::vector<TrackFrame>> ReadTracks(const std::string& path);

/// Reads cam0: sensor.yaml and those of tracks.csv, timestamps.csv and data.csv (with its images) that exist,
/// into the camera's part of `dataset`. Errors (kInput) as ReadDataset's.
Status ReadCameraFolder(const std::string& folder, Dataset* dataset);

/// Reads cam1, cam2, ... of the folder `mav`, consecutively numbered, where they hold tracks.csv; a camera
/// with images alone is skipped, because the front end tracks cam0 only. Errors (kInput) as ReadDataset's.
Status ReadExtraCameras(const std::string& mav, Dataset* dataset);

}  // namespace alidade
