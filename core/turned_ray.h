#pragma once

#include <Eigen/Core>

namespace alidade {

/// R times a ray, summed as Eigen sums R times (x, y).homogeneous(): of a ray (x, y, 1) to the last bit.
[[nodiscard]] inline Eigen::Vector3d TurnedRay(const Eigen::Matrix3d& R, const Eigen::Vector3d& ray) {
  const Eigen::Vector3d in_plane = R.leftCols<2>() * ray.head<2>();
  return in_plane + R.col(2) * ray.z();
}

}  // namespace alidade
