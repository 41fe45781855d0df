#pragma once

#include <Eigen/Core>

#include "core/bearing_plane.h"
#include "core/camera_model.h"
#include "core/navigation_state.h"

namespace alidade {

/// One observation of a landmark, the point z = (x, y) of a plane, with W: W (z - z_true) ~ N(0, I_2).
struct NormalizedObservation {
  Eigen::Vector2d z = Eigen::Vector2d::Zero();
  Eigen::Matrix2d sqrt_information = Eigen::Matrix2d::Identity();
  BearingPlane plane = {};  ///< the ideal normalised plane, unless the lens needs another
  /// Of the pixel, its row less that in the middle of the image: with a rolling shutter, when it was exposed.
  double row_px = 0;

  /// Geometric-mean standard deviation on the plane.
  [[nodiscard]] double deviation() const;
  /// Direction of what was seen, in the camera's frame: (x, y, 1), or of unit length where the plane touches
  /// the sphere in z.
  [[nodiscard]] Eigen::Vector3d Ray() const { return plane.Direction(z); }
};

/// Pixel -> observation on the camera's plane (CameraModel::plane): the normalised one, or the tangent plane
/// at the pixel's own ray, where z = 0. Pixel noise is carried through the lens model. False outside its
/// domain, or where the noise is not positive and finite.
bool NormalizeObservation(const CameraModel& camera, const Eigen::Vector2d& pixel, double pixel_noise_px,
                          NormalizedObservation* observation);

/// The observation of a pixel anew, with other intrinsics, on the plane that it has: coordinates of a
/// landmark on that plane stay true. False, with the observation untouched, outside the camera's domain.
bool RenormalizeObservation(const CameraModel& camera, const Eigen::Vector2d& pixel, double pixel_noise_px,
                            NormalizedObservation* observation);

/// d pixel / d z of an observation at its z, 2x2. False outside the camera's domain.
bool PixelJacobian(const CameraModel& camera, const NormalizedObservation& observation,
                   Eigen::Matrix2d* jacobian);

/// Direction of a pixel in the camera's frame: (x, y, 1) of the normalised plane, or of unit length where the
/// camera's plane is tangent. False outside its domain.
bool PixelRay(const CameraModel& camera, const Eigen::Vector2d& pixel, Eigen::Vector3d* ray);

/// d zeta_C / d zeta_B, 6x6 over (phi, dp): the pose error of a camera rigidly attached to the body with
/// extrinsics T_BC. phi_C = R_BC^T phi_B, dp_C = dp_B - R_WB [p_BC]x phi_B.
[[nodiscard]] Matrix6d BodyToCameraJacobian(const Eigen::Matrix3d& R_WB, const Pose& T_BC);

}  // namespace alidade
