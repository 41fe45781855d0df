#include "core/visual_observation.h"

#include <cmath>

namespace alidade {

double NormalizedObservation::deviation() const {
  return 1.0 / std::sqrt(std::abs(sqrt_information.determinant()));
}

bool NormalizeObservation(const CameraModel& camera, const Eigen::Vector2d& pixel, double pixel_noise_px,
                          NormalizedObservation* observation) {
  Eigen::Matrix2d pixel_jacobian;
  if (!camera.Unproject(pixel, &observation->z, &pixel_jacobian)) {
    return false;
  }
  observation->sqrt_information = pixel_jacobian / pixel_noise_px;
  return true;
}

Matrix6d BodyToCameraJacobian(const Eigen::Matrix3d& R_WB, const Pose& T_BC) {
  Matrix6d jacobian = Matrix6d::Identity();
  jacobian.topLeftCorner<3, 3>() = T_BC.rotation.transpose();
  jacobian.bottomLeftCorner<3, 3>() = -R_WB * Skew(T_BC.translation);
  return jacobian;
}

}  // namespace alidade
