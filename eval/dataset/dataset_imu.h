#pragma once

#include <string>

#include "core/status.h"
#include "eval/dataset/dataset.h"

namespace alidade {

class LogHasher;

// The IMU's part of a sequence: folder imu0 of `mav`.

/// Reads sensor.yaml and data.csv. Errors (kInput): those of ReadImuSensor; torn rows, units that are not
/// SI, stamps that do not increase, fewer than two samples.
Status ReadImuFolder(const std::string& mav, const DatasetStorage& storage, Dataset* dataset);
Status WriteImuFolder(const Dataset& dataset, const std::string& mav);

/// The samples; the noise is part of the rig.
Status DigestImu(const MeasurementLog& log, const LogTables& tables, LogHasher* hasher);

}  // namespace alidade
