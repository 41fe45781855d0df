#pragma once

#include <optional>
#include <vector>

#include "core/preintegration.h"
#include "gnss/model/satellite_measurement.h"

namespace alidade {

/// A GNSS epoch that hangs on a frame of the window: the IMU carries the frame's state on to it. Over the
/// tenths of a second between them the IMU's noise (millimetres) and the clock's are left out.
struct FrameEpoch {
  TimeNs stamp_ns = 0;
  EpochMeasurements measurements;  ///< located
  std::vector<ImuSample> imu;      ///< from the frame to the epoch; empty at the frame itself
  std::optional<Preintegration> preintegration;
  Eigen::Vector3d gyro_radps = Eigen::Vector3d::Zero();
  bool counted = false;    ///< in the statistics
  std::vector<bool> used;  ///< by row of LinearizeEpoch, after the gate; empty: all

  [[nodiscard]] double SecondsAfter(TimeNs frame_stamp_ns) const {
    return SecondsBetween(frame_stamp_ns, stamp_ns);
  }
};

}  // namespace alidade
