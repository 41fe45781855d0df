#pragma once

#include <optional>
#include <vector>

#include "eval/calibrate/camera_gyro_model.h"
#include "eval/calibrate/frame_pairs.h"

namespace alidade {

/// Variances of an estimate from the scatter of what each block of time moves it by; none with fewer than
/// four blocks. The sandwich estimator with clusters (Liang and Zeger 1986), each coordinate for itself.
/// `covariance`: by the information at the estimate; `gradients`: of each pair there; `prior`: zero for what
/// is held.
[[nodiscard]] std::optional<CameraGyroError> VariancesByBlocks(const std::vector<FramePair>& pairs,
                                                               const CameraGyroMatrix& covariance,
                                                               const std::vector<CameraGyroError>& gradients,
                                                               const CameraGyroError& prior, double block_s);

}  // namespace alidade
