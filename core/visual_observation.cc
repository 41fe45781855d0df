#include "core/visual_observation.h"

#include <cmath>

#include "core/reprojection.h"

namespace alidade {

double NormalizedObservation::deviation() const {
  return 1.0 / std::sqrt(std::abs(sqrt_information.determinant()));
}

bool NormalizeObservation(const CameraModel& camera, const Eigen::Vector2d& pixel, double pixel_noise_px,
                          NormalizedObservation* observation) {
  if (!(pixel_noise_px > 0) || !std::isfinite(pixel_noise_px)) {
    return false;
  }
  Eigen::Matrix2d pixel_jacobian;
  if (camera.plane() == ObservationPlane::kNormalized) {
    if (!camera.Unproject(pixel, &observation->z, &pixel_jacobian)) {
      return false;
    }
    observation->plane = BearingPlane();
  } else {
    Eigen::Vector3d ray;
    if (!camera.Bearing(pixel, &ray)) {
      return false;
    }
    NormalizedObservation seen;
    seen.plane = BearingPlane::TangentAt(ray);
    if (!PixelJacobian(camera, seen, &pixel_jacobian)) {
      return false;
    }
    *observation = seen;
  }
  observation->sqrt_information = pixel_jacobian / pixel_noise_px;
  observation->row_px = pixel.y() - 0.5 * camera.height_px();
  return true;
}

bool RenormalizeObservation(const CameraModel& camera, const Eigen::Vector2d& pixel, double pixel_noise_px,
                            NormalizedObservation* observation) {
  NormalizedObservation seen = *observation;
  Eigen::Matrix2d pixel_jacobian;
  if (!seen.plane.is_tangent()) {
    if (!camera.Unproject(pixel, &seen.z, &pixel_jacobian)) {
      return false;
    }
  } else {
    Eigen::Vector3d ray;
    if (!camera.Bearing(pixel, &ray) || !ProjectToPlane(seen.plane, ray, kMinPointDepth, &seen.z) ||
        !PixelJacobian(camera, seen, &pixel_jacobian)) {
      return false;
    }
  }
  seen.sqrt_information = pixel_jacobian / pixel_noise_px;
  *observation = seen;
  return true;
}

bool PixelJacobian(const CameraModel& camera, const NormalizedObservation& observation,
                   Eigen::Matrix2d* jacobian) {
  Eigen::Vector2d unused;
  if (!observation.plane.is_tangent()) {
    Eigen::Matrix2d of_ideal;
    if (!camera.Distort(observation.z, &unused, &of_ideal)) {
      return false;
    }
    *jacobian = camera.intrinsics().head<2>().asDiagonal() * of_ideal;
    return true;
  }
  PointRows<2> of_ray;
  if (!camera.Project(observation.Ray(), &unused, &of_ray)) {
    return false;
  }
  *jacobian = of_ray * observation.plane.axes().leftCols<2>();
  return true;
}

bool PixelRay(const CameraModel& camera, const Eigen::Vector2d& pixel, Eigen::Vector3d* ray) {
  if (camera.plane() == ObservationPlane::kTangent) {
    return camera.Bearing(pixel, ray);
  }
  Eigen::Vector2d ideal;
  if (!camera.Unproject(pixel, &ideal)) {
    return false;
  }
  *ray = ideal.homogeneous();
  return true;
}

Matrix6d BodyToCameraJacobian(const Eigen::Matrix3d& R_WB, const Pose& T_BC) {
  Matrix6d jacobian = Matrix6d::Identity();
  jacobian.topLeftCorner<3, 3>() = T_BC.rotation.transpose();
  jacobian.bottomLeftCorner<3, 3>() = -R_WB * Skew(T_BC.translation);
  return jacobian;
}

}  // namespace alidade
