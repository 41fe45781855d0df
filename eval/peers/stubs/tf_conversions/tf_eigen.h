// In place of ROS: transforms that are drawn.
#pragma once

#include "../eigen_conversions/eigen_msg.h"
#include "../tf/transform_broadcaster.h"

namespace tf {

inline void transformEigenToTF(const Eigen::Isometry3d&, Transform&) {}

}  // namespace tf
