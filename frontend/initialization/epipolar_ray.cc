#include "frontend/initialization/epipolar_ray.h"

#include <Eigen/Eigenvalues>

#include "core/robust.h"

namespace alidade {

double EpipolarVariance(const EpipolarRay& ray, const Eigen::Vector3d& direction) {
  const double lever =
      0.5 * (direction.cross(ray.ray_i).squaredNorm() + direction.cross(ray.ray_j).squaredNorm());
  return ray.sigma * ray.sigma * (lever + 1e-4);
}

Eigen::Vector3d TranslationDirection(const std::vector<EpipolarRay>& rays, double kernel_sigma,
                                     std::vector<double>* weights) {
  weights->assign(rays.size(), 1.0);
  for (std::size_t k = 0; k < rays.size(); ++k) {
    const double floor = 3 * rays[k].sigma;
    (*weights)[k] = 1.0 / (rays[k].normal.squaredNorm() + floor * floor);
  }
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();
  for (int round = 0; round < 4; ++round) {
    Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
    for (std::size_t k = 0; k < rays.size(); ++k) {
      scatter += (*weights)[k] * rays[k].normal * rays[k].normal.transpose();
    }
    direction = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(scatter).eigenvectors().col(0);
    for (std::size_t k = 0; k < rays.size(); ++k) {
      const double residual = direction.dot(rays[k].normal);
      const double variance = EpipolarVariance(rays[k], direction);
      (*weights)[k] =
          RobustWeight(RobustKernel::kCauchy, kernel_sigma, residual * residual / variance) / variance;
    }
  }
  return direction;
}

}  // namespace alidade
