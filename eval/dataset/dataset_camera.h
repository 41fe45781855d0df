#pragma once

#include <string>
#include <vector>

#include "eval/dataset/dataset.h"
#include "eval/files/csv.h"

namespace alidade {

/// A CSV file whose header row has been checked and passed. Errors (kInput): no file, empty, another header.
Result<CsvReader> OpenTable(const std::string& path, const std::vector<CsvColumn>& header);

/// Mean rate of `count` stamps between the first and the last [Hz]; 0 when there are fewer than two.
[[nodiscard]] double MeasuredRate(TimeNs first, TimeNs last, size_t count);

/// tracks.csv, grouped by stamp, each frame sorted by track id. Errors (kInput): torn rows, stamps out of
/// order, a track twice in a frame, none at all.
Result<std::vector<TrackFrame>> ReadTracks(const std::string& path);

/// Reads cam0: sensor.yaml and whichever of tracks.csv, timestamps.csv, data.csv with its images are there,
/// into the camera's part of `dataset`. Errors (kInput) as ReadDataset's.
Status ReadCameraFolder(const std::string& folder, Dataset* dataset);

/// Reads cam1, cam2, ... of the folder `mav`, as far as they count up, where they hold tracks.csv; one with
/// images alone is passed over, since nothing here tracks them. Errors (kInput) as ReadDataset's.
Status ReadExtraCameras(const std::string& mav, Dataset* dataset);

}  // namespace alidade
