#pragma once

#include "smoother/factors/gnss_factors.h"
#include "smoother/solve/window_term.h"
#include "smoother/window/window_calibration.h"

namespace alidade {

/// What the sensors' terms need besides the frames.
struct SensorContext {
  Eigen::Vector3d gravity_W = Eigen::Vector3d::Zero();
  const GnssFactorContext* gnss = nullptr;  ///< of an aligned window
  const WindowCalibration* calibration = &NotCalibrated();
};

/// Appends the terms of all sensors but the camera over the first `count` frames: IMU between them, rest,
/// measurements between frames, GNSS epochs and clocks, in this order. Frames and context must outlive the
/// terms. kDiverged: the covariance of an IMU interval is not positive definite.
Status AddSensorTerms(const SensorContext& context, const WindowFrames& frames, int count,
                      WindowTerms* terms);

}  // namespace alidade
