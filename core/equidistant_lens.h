#pragma once

#include <Eigen/Core>

namespace alidade {

/// Distorted radius t (1 + k1 t^2 + k2 t^4 + k3 t^6 + k4 t^8) of the equidistant lens (core/camera_model.h)
/// at the angle t [rad] off axis. k: k1 to k4. `by_angle`: its derivative by t; `by_coefficients`,
/// unless null: by k1 to k4.
inline double EquidistantRadius(double t, const Eigen::Vector4d& k, double* by_angle,
                                Eigen::RowVector4d* by_coefficients = nullptr) {
  const double t2 = t * t;
  *by_angle = 1 + t2 * (3 * k[0] + t2 * (5 * k[1] + t2 * (7 * k[2] + t2 * 9 * k[3])));
  if (by_coefficients != nullptr) {
    *by_coefficients = t2 * t * Eigen::RowVector4d(1, t2, t2 * t2, t2 * t2 * t2);
  }
  return t * (1 + t2 * (k[0] + t2 * (k[1] + t2 * (k[2] + t2 * k[3]))));
}

}  // namespace alidade
