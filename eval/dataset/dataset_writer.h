#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/status.h"
#include "core/track_frame.h"
#include "eval/dataset/dataset.h"

namespace alidade {

/// Writes imu0, cam0 (tracks, stamps) and truth under `path`. Numbers are the shortest text that reads back
/// equal.
Status WriteDataset(const Dataset& dataset, const std::string& path);
/// sensor.yaml of extra_cameras[k].
[[nodiscard]] std::string ExtraCameraYaml(const Dataset& dataset, size_t k);
/// Writes cam0/tracks.csv (and its sensor.yaml) alone: the output of the `track` command.
Status WriteTracks(const std::vector<TrackFrame>& tracks, const std::string& csv_path);

}  // namespace alidade
