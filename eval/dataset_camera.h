#pragma once

#include <string>
#include <vector>

#include "eval/csv.h"
#include "eval/dataset.h"

namespace alidade {

/// A CSV file whose header row has been checked and passed. Errors (kInput): no file, empty, another header.
Result<CsvReader> OpenTable(const std::string& path, const std::vector<CsvColumn>& header);

/// Mean rate of `count` stamps between the first and the last [Hz]; 0 when there are fewer than two.
[[nodiscard]] double MeasuredRate(TimeNs first, TimeNs last, size_t count);

/// Reads cam0: sensor.yaml and whichever of tracks.csv, timestamps.csv, data.csv with its images are there,
/// into the camera's part of `dataset`. Errors (kInput) as ReadDataset's.
Status ReadCameraFolder(const std::string& folder, Dataset* dataset);

}  // namespace alidade
