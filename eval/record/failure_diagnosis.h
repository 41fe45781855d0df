#pragma once

#include <optional>
#include <string>

#include "core/estimator/measurement_log.h"
#include "core/estimator_config.h"
#include "eval/dataset/log_tables.h"
#include "eval/record/run_options.h"
#include "eval/record/run_result.h"

namespace alidade {

/// Whether a run never started, was lost, or had to start again.
[[nodiscard]] bool Failed(const RunResult& result);

/// Looks for signs of the accelerometer's axes with which the filter runs through the first 25 s of a log, of
/// which `tables` are the long tables, that the run `failed` with `config` failed on. The gyroscope's signs
/// show in the rotation of the images (CheckCameraAgainstGyro), those of the accelerometer only in an
/// estimate. A sentence for people, or empty: the run was sound for more than 5 s in motion, no other signs
/// do better, or the log has no camera. Takes up to eight short runs.
[[nodiscard]] std::optional<std::string> DiagnoseAccelerometerSigns(const EstimatorConfig& config,
                                                                    const MeasurementLog& log,
                                                                    const LogTables& tables,
                                                                    const RunResult& failed,
                                                                    const RunOptions& options);

}  // namespace alidade
