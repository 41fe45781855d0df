#pragma once

#include <Eigen/Core>

#include "core/rig_calibration.h"
#include "core/track_frame.h"

namespace alidade {

/// Observations of a rolling shutter as the camera would have made them had it turned no further than it had
/// when it exposed the middle row: each ray goes back by the rotation of CameraAfter (core/body_motion.h)
/// since, at the constant rate `gyro_radps`. What the camera moves meanwhile needs the depths, which are
/// unknown before a start, and stays: v t / depth, 2e-3 rad at 1 m/s, 10 ms and 5 m. Without a line delay,
/// and where a ray leaves the camera's domain, an observation stays as it is.
[[nodiscard]] TrackFrame AtMiddleRow(const RigCalibration& rig, const Eigen::Vector3d& gyro_radps,
                                     TrackFrame frame);

}  // namespace alidade
