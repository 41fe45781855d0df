#pragma once

#include <Eigen/Core>

namespace alidade {

/// A feature in an image, as the solvers of VINS-Mono and GVINS take it.
struct VinsFeature {
  int id = 0;
  Eigen::Vector2d plane = Eigen::Vector2d::Zero();     ///< undistorted, normalised plane
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();     ///< raw [px]
  Eigen::Vector2d velocity = Eigen::Vector2d::Zero();  ///< of `plane` [1/s]
};

}  // namespace alidade
