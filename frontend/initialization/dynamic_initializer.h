#pragma once

#include <deque>
#include <string>

#include "core/estimator_config.h"
#include "core/imu_buffer.h"
#include "core/rig_calibration.h"
#include "core/status.h"
#include "core/track_frame.h"
#include "frontend/initialization/initializer_window.h"

namespace alidade {

/// A state found in motion, and the figures that let it pass.
struct DynamicSolution {
  NavEstimate estimate;  ///< stamp in IMU time
  std::string report;
  InitializerWindow window;  ///< likewise
};

/// What a solution must meet at this point of the search.
struct DynamicLimits {
  double scale_std = 0;  ///< relative standard deviation of the scale, at most
  double longest_s = 0;  ///< of the window
};

/// Initialises from the newest frames in motion: gyroscope bias from epipolar geometry (gyro_bias_fit.h),
/// velocity and gravity in closed form (linear_start.h), maximum likelihood over the window,
/// accelerometer bias included (start_refinement.h), then the checks that accept it. The IMU counts as
/// noisier than its sheet where its samples scatter more. Stamps of `frames` are in IMU time. `accel_bias`
/// [m/s^2] is where the search for it begins, zero at first; it becomes what this attempt found, refused or
/// not, where that is plausible. Error (kDiverged): why there is no solution yet, with the figure and its
/// limit.
Result<DynamicSolution> InitializeDynamic(const EstimatorConfig& config, const RigCalibration& rig,
                                          const std::deque<TrackFrame>& frames, const DynamicLimits& limits,
                                          ImuBuffer* imu, Eigen::Vector3d* accel_bias);

}  // namespace alidade
