#pragma once

#include <Eigen/Core>
#include <array>
#include <atomic>

#include "core/estimator/measurement_log.h"
#include "core/estimator_config.h"

namespace alidade {

/// Factors of +-1 on the axes of an accelerometer.
struct AccelerometerSigns {
  Eigen::Vector3d signs;
  const char* name;  ///< the axes that are negated
};

/// Those given first, then the likeliest first.
[[nodiscard]] const std::array<AccelerometerSigns, 8>& SignChoices();

/// The log with the accelerometer's axes times `signs`.
[[nodiscard]] MeasurementLog WithSigns(MeasurementLog log, const Eigen::Vector3d& signs);

/// Whether images, gyroscope and accelerometer agree on the motion in at least two of five windows of 1.25
/// init.dynamic_window_s, spread over the log: a start in motion is found there (Initializer, at a relative
/// deviation of the scale of up to one half). Gravity and accelerations of a wrong sign contradict the motion
/// of the tracks. No estimator runs. False also where the log is at rest, and when `stop` is set.
[[nodiscard]] bool StartsInMotion(const EstimatorConfig& config, const MeasurementLog& log,
                                  const std::atomic<bool>* stop);

}  // namespace alidade
