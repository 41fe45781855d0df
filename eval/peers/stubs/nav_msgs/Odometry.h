// In place of ROS.
#pragma once

#include <string>

#include "../geometry_msgs/PoseStamped.h"

namespace nav_msgs {

struct Odometry {
  std_msgs::Header header;
  std::string child_frame_id;
  struct {
    geometry_msgs::Pose pose;
  } pose;
  struct {
    struct {
      geometry_msgs::Vector3 linear, angular;
    } twist;
  } twist;
};

}  // namespace nav_msgs
