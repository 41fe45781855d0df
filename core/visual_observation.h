#pragma once

#include <Eigen/Core>

#include "core/camera_model.h"
#include "core/navigation_state.h"

namespace alidade {

/// One observation of a landmark on the ideal normalised plane z = (x, y), with W: W (z - z_true) ~ N(0,
/// I_2).
struct NormalizedObservation {
  Eigen::Vector2d z = Eigen::Vector2d::Zero();
  Eigen::Matrix2d sqrt_information = Eigen::Matrix2d::Identity();

  /// Geometric-mean standard deviation on the normalised plane.
  [[nodiscard]] double deviation() const;
};

/// Pixel -> normalised observation; pixel noise is carried through the lens model. False outside its domain.
bool NormalizeObservation(const CameraModel& camera, const Eigen::Vector2d& pixel, double pixel_noise_px,
                          NormalizedObservation* observation);

/// d zeta_C / d zeta_B, 6x6 over (phi, dp): the pose error of a camera rigidly attached to the body with
/// extrinsics T_BC. phi_C = R_BC^T phi_B, dp_C = dp_B - R_WB [p_BC]x phi_B.
[[nodiscard]] Matrix6d BodyToCameraJacobian(const Eigen::Matrix3d& R_WB, const Pose& T_BC);

}  // namespace alidade
