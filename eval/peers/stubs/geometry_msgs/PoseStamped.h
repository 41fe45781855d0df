// In place of ROS.
#pragma once

#include "../std_msgs/Header.h"

namespace geometry_msgs {

struct Vector3 {
  double x = 0, y = 0, z = 0;
};
using Point = Vector3;
struct Quaternion {
  double x = 0, y = 0, z = 0, w = 1;
};
struct Pose {
  Point position;
  Quaternion orientation;
};
struct PoseStamped {
  std_msgs::Header header;
  Pose pose;
};

}  // namespace geometry_msgs
