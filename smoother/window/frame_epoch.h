#pragma once

#include <vector>

#include "gnss/model/satellite_measurement.h"
#include "smoother/window/imu_link.h"

namespace alidade {

/// A GNSS epoch that is attached to a frame of the window. The clock's noise between them is left out too.
struct FrameEpoch : ImuLink {
  TimeNs stamp_ns = 0;
  EpochMeasurements measurements;  ///< located
  Eigen::Vector3d gyro_radps = Eigen::Vector3d::Zero();
  bool counted = false;    ///< in the statistics
  std::vector<bool> used;  ///< by row of LinearizeEpoch, after the gate; empty: all

  [[nodiscard]] double SecondsAfter(TimeNs frame_stamp_ns) const {
    return SecondsBetween(frame_stamp_ns, stamp_ns);
  }
};

}  // namespace alidade
