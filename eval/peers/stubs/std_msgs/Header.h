// In place of ROS.
#pragma once

#include <string>

#include "../ros/time.h"

namespace std_msgs {

struct Header {
  ros::Time stamp;
  std::string frame_id;
};

}  // namespace std_msgs
