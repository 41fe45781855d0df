#pragma once

#include <optional>
#include <span>
#include <string>

#include "core/imu_statistics.h"
#include "core/init_config.h"
#include "core/navigation_state.h"
#include "frontend/initialization/track_motion.h"

namespace alidade {

/// What the IMU did over an interval.
struct ImuSpread : ImuStatistics {
  double duration_s = 0;
  int samples = 0;
  /// Of the mean, one axis, from the scatter of ten block means: counts slow vibration.
  double gyro_mean_std_radps = 0;
  double accel_mean_std_mps2 = 0;  ///< likewise
  double accel_drift_mps2 = 0;     ///< between the means of the two halves: a slow rotation shows here
};
/// Needs at least two samples.
[[nodiscard]] ImuSpread MeasureImuSpread(std::span<const ImuSample> samples);

enum class StaticVerdict { kAtRest, kTooShort, kMoving };
struct RestAssessment {
  StaticVerdict verdict = StaticVerdict::kTooShort;
  std::string reason;  ///< why not at rest, with the figure and its limit
};

/// At rest when the spread of both sensors, the change of specific force, its magnitude, the mean rate and,
/// when frames carry tracks, the image motion are below the limits of `config`. Neglected: without tracks a
/// constant velocity, or a constant rotation about the vertical slower than a plausible gyroscope bias (0.2
/// rad/s), looks like rest. motion: of the newest frame against one about a window older, empty when frames
/// carry no tracks.
[[nodiscard]] RestAssessment AssessRest(const InitConfig& config, double gravity_mps2,
                                        const ImuSpread& spread, const std::optional<TrackMotion>& motion);

/// State of a body at rest from its mean measurements f and w: gyroscope bias w; up in the body u = f / |f|
/// gives roll and pitch (yaw 0, Hamilton z-y-x); accelerometer bias (|f| - g) u, the only part of it that
/// rest shows.
///
/// Covariance (canonical chart) from the linear relation f = g u + g [u]x phi + b_a + n with priors on b_a
/// and on the rotation about u: the bias across u and the tilt it feigns, phi = u x b_a / g, come out fully
/// correlated. The noise n is the larger of the sensor sheet's and that seen in the block means; gravity and
/// the accelerometer's scale are trusted to 0.02 m/s^2 along u.
[[nodiscard]] NavEstimate StateAtRest(const InitConfig& config, double gravity_mps2, const ImuNoise& noise,
                                      const ImuSpread& spread, TimeNs stamp_ns);

}  // namespace alidade
