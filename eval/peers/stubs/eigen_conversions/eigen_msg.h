// In place of ROS.
#pragma once

#include <Eigen/Geometry>

#include "../geometry_msgs/PoseStamped.h"

namespace tf {

inline void vectorMsgToEigen(const geometry_msgs::Vector3& message, Eigen::Vector3d& vector) {
  vector = Eigen::Vector3d(message.x, message.y, message.z);
}
inline void vectorEigenToMsg(const Eigen::Vector3d& vector, geometry_msgs::Vector3& message) {
  message = {vector.x(), vector.y(), vector.z()};
}
inline void poseEigenToMsg(const Eigen::Isometry3d& pose, geometry_msgs::Pose& message) {
  const Eigen::Quaterniond q(pose.linear());
  vectorEigenToMsg(pose.translation(), message.position);
  message.orientation = {q.x(), q.y(), q.z(), q.w()};
}

}  // namespace tf
