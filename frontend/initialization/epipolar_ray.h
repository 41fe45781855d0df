#pragma once

#include <Eigen/Core>
#include <vector>

namespace alidade {

/// One landmark seen by two cameras i and j, both rays in the same axes: with the translation direction t
/// between the cameras, t . normal = 0.
struct EpipolarRay {
  Eigen::Vector3d ray_i = Eigen::Vector3d::UnitZ();  ///< unit length
  Eigen::Vector3d ray_j = Eigen::Vector3d::UnitZ();
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  ///< ray_i x ray_j
  double sigma = 0;                                  ///< of the angle of both rays together [rad]
};

/// Variance of direction . normal: noise of both rays across the plane they span with the direction. Near the
/// epipole it vanishes to first order, hence the floor.
[[nodiscard]] double EpipolarVariance(const EpipolarRay& ray, const Eigen::Vector3d& direction);

/// Translation direction: least eigenvector of the weighted scatter of the epipolar normals (Kneip and Lynen
/// 2013). The first estimate counts every ray by its direction alone, which bounds what a wrong one can do;
/// then Cauchy weights of scale `kernel_sigma` follow the residuals. weights: one a ray, robust weight over
/// variance. Rays must not be empty.
[[nodiscard]] Eigen::Vector3d TranslationDirection(const std::vector<EpipolarRay>& rays, double kernel_sigma,
                                                   std::vector<double>* weights);

}  // namespace alidade
