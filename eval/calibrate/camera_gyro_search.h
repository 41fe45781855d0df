#pragma once

#include <vector>

#include "eval/calibrate/camera_gyro_fit.h"

namespace alidade {

struct CameraGyroSearchOptions {
  std::vector<double> focal_factors = {1};    ///< starts for the focal length, times the given one
  CameraGyroError prior = CameraGyroPrior();  ///< of the final fit, about what the search has found
};

/// FitCameraToGyro from starts spread over time offsets within 0.25 s; where none of them explains the
/// images, also over the 24 right-handed conventions of axes and over a gyroscope of negated sign. The starts
/// are fitted to the pairs with the largest rotations; the best goes on with all pairs.
///
/// Errors (kInput): too few pairs; no start explains the images.
Result<CameraGyroFit> FindCameraGyro(const std::vector<FramePair>& pairs, const std::vector<ImuSample>& imu,
                                     const CameraGyroModel& given, const CameraGyroSearchOptions& options);

}  // namespace alidade
