#pragma once

#include <span>
#include <vector>

#include "core/imu_sample.h"
#include "smoother/truth/truth_pose_model.h"

namespace alidade {

/// A recorded pose of the marker in the frame of the truth, by the clock of the truth.
struct TruthPose {
  TimeNs stamp_ns = 0;
  Pose T_TM;
};

/// The motion at one stamp.
struct TruthState {
  NavState nav;
  ImuBias bias;
};

/// Initial values of a refinement.
struct TruthStart {
  TruthConstants constants;
  std::vector<TruthState> states;  ///< at the stamps of the IMU samples
};

/// Initial values from turns over 0.1 s, by poses and gyroscope: the time offset (within 0.3 s) and
/// the rotation of the marker at which they agree best in the median, then the vertical from the mean
/// specific force. Where the turns do not determine a rotation better than none, the marker counts as
/// parallel to the body. States: poses as recorded, between them rotation by the gyroscope, position linear;
/// velocities are differences over 0.1 s. The lever arm and the bias of the accelerometer start at zero. At
/// least two samples and two poses.
[[nodiscard]] TruthStart StartTruth(std::span<const ImuSample> imu, std::span<const TruthPose> poses);

}  // namespace alidade
