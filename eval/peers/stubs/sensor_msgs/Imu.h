// In place of ROS.
#pragma once

#include "../geometry_msgs/PoseStamped.h"
#include "../ros/message.h"

namespace sensor_msgs {

struct Imu {
  STUB_POINTERS_WITHIN(Imu);
  std_msgs::Header header;
  geometry_msgs::Vector3 angular_velocity, linear_acceleration;
};
STUB_POINTERS(Imu);

}  // namespace sensor_msgs
