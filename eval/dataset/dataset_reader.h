#pragma once

#include <string>

#include "core/status.h"
#include "eval/dataset/dataset.h"

namespace alidade {

/// Reads everything but pixels of a folder; a ROS bag: ReadDataset of eval/bag/dataset_source.h. Every fault
/// is kInput naming file, line, value and expectation: missing file, wrong header, torn row, non-finite
/// number, stamps not increasing, non-rigid T_BS, unknown distortion model, wrong resolution. kOutput: those
/// of SpoolFile.
Result<Dataset> ReadDataset(const std::string& path, const DatasetStorage& storage = {});

}  // namespace alidade
