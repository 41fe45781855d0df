#pragma once

#include <limits>
#include <vector>

#include "eval/comparison/comparison.h"
#include "eval/record/run_record.h"

namespace alidade {

/// Innovations of a sensor in a frame's statistics.
struct Innovations {
  double nis = 0;  ///< sum of normalised innovations squared
  int dof = 0;     ///< number of their rows

  /// NaN without rows.
  [[nodiscard]] double Ratio() const {
    return dof > 0 ? nis / dof : std::numeric_limits<double>::quiet_NaN();
  }
};
/// sensor: not the IMU.
[[nodiscard]] Innovations InnovationsOf(Sensor sensor, const FrameStatistics& frame);

/// GNSS and those of SensorEntries.
[[nodiscard]] std::vector<Sensor> SensorsBetweenFrames();

/// Of the frames with innovations of the sensor; nothing is known without any.
[[nodiscard]] InnovationSummary SummarizeInnovations(Sensor sensor, const std::vector<RunRecord>& records);

}  // namespace alidade
