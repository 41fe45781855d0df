#pragma once

#include <Eigen/Core>

#include "filter/filter_state.h"

namespace alidade {

/// The whitened rows of one view of a landmark over the error of a FilterState, before the landmark is
/// eliminated. Where the landmark's error is anchored, LandmarkError::OverAnchor of `landmark` completes
/// them.
struct LandmarkViewRows {
  Eigen::Vector2d residual;              ///< predicted - measured, at the present estimates
  Eigen::Matrix<double, 2, 6> clone;     ///< over the error of the view's clone
  Eigen::Matrix<double, 2, 3> landmark;  ///< over an additive error of p_W
  /// Over the calibration, as far as it is estimated.
  Eigen::Matrix<double, 2, Eigen::Dynamic, Eigen::ColMajor, 2, CalibrationLayout::kMaxSize> calibration;
};

/// Linearises the view of a clone: residual at the present pose and p_W, Jacobians at
/// clone.T_WC_jacobian and `jacobian_p_W`. False when the landmark lies behind the camera.
bool LinearizeView(const FilterState& state, const Clone& clone, const NormalizedObservation& observation,
                   const Eigen::Vector3d& p_W, const Eigen::Vector3d& jacobian_p_W, LandmarkViewRows* rows);

}  // namespace alidade
