#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/estimator/estimator.h"
#include "eval/files/csv.h"

namespace alidade {

// Columns of SensorEntries, behind the other columns of status.csv.

inline constexpr std::size_t kColumnsPerSensor = 4;

/// ",fixes_used,fixes_gated,...": of the sensors that the configuration enables.
[[nodiscard]] std::string SensorColumns(const EstimatorConfig& config);
[[nodiscard]] std::string SensorFields(const EstimatorConfig& config, const FrameStatistics& statistics);

/// Reads the fields of these sensors, in the order of SensorEntries, from the column `first` on.
Status ReadSensorFields(const CsvReader& row, std::size_t first, const std::vector<Sensor>& sensors,
                        FrameStatistics* statistics);

}  // namespace alidade
