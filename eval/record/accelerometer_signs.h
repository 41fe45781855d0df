#pragma once

#include <Eigen/Core>
#include <array>
#include <atomic>
#include <cstddef>
#include <functional>
#include <optional>

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

/// How a combination is tried; `choice` is its index in SignChoices().
struct SignTrials {
  std::function<bool(std::size_t choice)> starts;  ///< cheap: whether starts are found
  /// Seconds that a run got through; empty: it failed.
  std::function<std::optional<double>(std::size_t choice)> holds;
  std::function<bool()> stopped;
};

struct SignFinding {
  std::size_t choice = 0;
  double held_s = 0;
};

/// The first combination with which a run holds, of those that start. Empty also: with the signs as given
/// starts are found, or a run holds; kMostReruns others did not hold; or the search was stopped.
[[nodiscard]] std::optional<SignFinding> SearchSigns(const SignTrials& trials);

inline constexpr int kMostReruns = 3;

}  // namespace alidade
