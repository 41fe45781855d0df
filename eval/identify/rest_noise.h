#pragma once

#include <array>
#include <vector>

#include "eval/identify/noise_fit.h"
#include "eval/identify/rest_span.h"

namespace alidade {

/// Noise of one axis at rest.
struct AxisNoise {
  std::vector<AllanPoint> curve;
  NoiseFit fit;
  double least_deviation = 0;  ///< of the curve's points with at least ten degrees of freedom
  double least_tau_s = 0;      ///< where
  double resolution = 0;       ///< least difference of two values of the axis; 0: all are equal
};

/// Noise of an IMU at rest.
struct RestNoise {
  RestSpan span;
  std::array<AxisNoise, 6> axes;     ///< gyroscope x, y, z, accelerometer x, y, z
  ImuNoise sheet;                    ///< root mean square over the axes of each sensor
  std::vector<std::string> remarks;  ///< on the sheet, and those of the span
};

/// Names and unit of the axes.
inline constexpr std::array<const char*, 6> kAxisNames = {"gyro x",  "gyro y",  "gyro z",
                                                          "accel x", "accel y", "accel z"};

/// Allan deviation of each axis over the recording's longest span at rest, with the noises fitted. A walk
/// that is not visible enters the sheet at its upper bound: a filter needs one that is not zero. Errors:
/// FindRestSpan's; kInput: an axis does not change.
Result<RestNoise> IdentifyAtRest(const std::vector<ImuSample>& imu, const InitConfig& init);

}  // namespace alidade
