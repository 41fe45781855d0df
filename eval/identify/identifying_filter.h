#pragma once

#include "core/estimator/measurement_log.h"
#include "core/estimator_config.h"
#include "eval/identify/linear_recorder.h"
#include "eval/record/run_options.h"

namespace alidade {

/// The filter whose innovations are used: `config` with every observation of a track used once, when it ends
/// (filter.update delayed_all), nothing kept of it afterwards, no landmarks in the state, no online
/// calibration, no kernel, and a gate that refuses none but gross errors. The likelihood then is that of the
/// model.
[[nodiscard]] EstimatorConfig IdentifyingFilter(const EstimatorConfig& config);

/// The noises that configuration and log assume, in the order of NoiseSource; the factors are 1.
[[nodiscard]] PerNoise AssumedNoise(const EstimatorConfig& config, const MeasurementLog& log);
[[nodiscard]] ImuNoise ImuNoiseOf(const PerNoise& noise);
/// Sets these noises in configuration and log; factors are on the noise of `given`.
void AssumeNoise(const PerNoise& noise, const EstimatorConfig& given, EstimatorConfig* config,
                 MeasurementLog* log);

/// Runs the filter of `config`, an IdentifyingFilter with imu.noise_scale and random_walk_scale 1, and
/// records it. Errors: the run's; kDiverged: interrupted.
Result<LinearSystem> RecordFilter(const EstimatorConfig& config, const MeasurementLog& log,
                                  const RunOptions& options);

}  // namespace alidade
