#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "core/imu_sample.h"
#include "core/init_config.h"
#include "core/status.h"

namespace alidade {

/// Samples of an IMU at rest, evenly spaced.
struct RestSpan {
  TimeNs start_ns = 0;
  TimeNs end_ns = 0;
  double recording_s = 0;  ///< the whole recording's duration
  double rest_s = 0;       ///< of it at rest, all spans together
  double period_s = 0;
  double jitter_rms_s = 0;           ///< of the stamps' differences about whole periods
  std::size_t gaps = 0;              ///< missing samples in a row, filled by straight lines
  std::size_t filled = 0;            ///< samples in them
  std::vector<std::string> remarks;  ///< what was left out or assumed
  /// Angular rate x, y, z [rad/s], specific force x, y, z [m/s^2], each a row of equal length.
  std::array<std::vector<double>, 6> axes;

  [[nodiscard]] std::size_t samples() const { return axes[0].size(); }
  [[nodiscard]] double duration_s() const { return period_s * static_cast<double>(samples()); }
};

/// The longest span at rest of a recording, from the IMU alone. A window of one second is at rest when
///   - the spread of its rates and of its specific forces is below what the static start allows
///     (InitConfig::static_max_gyro_std_radps, static_max_accel_std_mps2) and below twice the lower
///     quartile of such windows, and
///   - its means differ from those of the window before by less than eight times the lower quartile of
///     such differences.
/// A span also ends at a silence of more than kLongestFilledGap samples; fewer missing samples are filled by
/// straight lines. Neglected: a rotation at constant rate, which spreads as little as rest.
///
/// kInput: fewer than 100 samples, or no span of at least kShortestRest_s.
Result<RestSpan> FindRestSpan(const std::vector<ImuSample>& imu, const InitConfig& init);

inline constexpr double kShortestRest_s = 10;
inline constexpr std::size_t kLongestFilledGap = 20;

}  // namespace alidade
