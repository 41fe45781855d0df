#pragma once

#include <vector>

#include "eval/dataset/dataset.h"
#include "eval/dataset/dataset_findings.h"

namespace alidade {

/// Rates, gaps, units (gravity magnitude, gyro in rad/s), implausible calibrations, time spans, offsets
/// between sensors, tracks, duplicates.
[[nodiscard]] std::vector<DatasetFinding> CheckDataset(const Dataset& dataset);

}  // namespace alidade
