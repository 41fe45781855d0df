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

/// Looks for signs of the accelerometer's axes with which the data of a start that `failed` with `config`
/// agree; `tables` are the long tables of the log. Units, the gyroscope's signs and the clocks are compared
/// before a run (CheckDataset, CheckCameraAgainstGyro); the signs of the accelerometer only show where
/// images, gyroscope and accelerometer meet. Of 25 s of data, from 10 s before the loss on or from the first
/// frame, each of the eight combinations is first tried by starts in motion (StartsInMotion), without a run;
/// one that passes is confirmed by a run of the filter over the same data, at most kMostReruns of them.
/// Before the first of these the filter must fail with the signs as given.
///
/// options.progress is called before each combination with its number from 1 and that of all; options.stop
/// ends the search between and within them. A sentence for people, or empty: the run was sound for more than
/// 5 s in motion, the filter holds with the signs as given, no others do better, the log has no camera, or
/// the search was stopped. Deterministic.
[[nodiscard]] std::optional<std::string> DiagnoseAccelerometerSigns(const EstimatorConfig& config,
                                                                    const MeasurementLog& log,
                                                                    const LogTables& tables,
                                                                    const RunResult& failed,
                                                                    const RunOptions& options);

}  // namespace alidade
