#pragma once

#include <Eigen/LU>

#include "core/visual_observation.h"

namespace alidade {

/// The observation as predicted, whitened as measured. residual: whitened, predicted - measured.
///
/// Rows over the intrinsics belong here: taken at the measured ray they would share its noise with the
/// residual, and H^T r would then not average to zero. Over thousands of views that pulls the focal length by
/// many of its standard deviations.
[[nodiscard]] inline NormalizedObservation Predicted(const NormalizedObservation& measured,
                                                     const Eigen::Vector2d& residual) {
  return {measured.z + measured.sqrt_information.inverse() * residual, measured.sqrt_information,
          measured.plane, measured.row_px};
}

}  // namespace alidade
