// In place of ROS.
#pragma once

#include "../ros/message.h"
#include "../std_msgs/Header.h"

namespace sensor_msgs {

struct NavSatStatus {
  static constexpr int STATUS_FIX = 0;
  int status = -1;
};
struct NavSatFix {
  STUB_POINTERS_WITHIN(NavSatFix);
  std_msgs::Header header;
  NavSatStatus status;
  double latitude = 0, longitude = 0, altitude = 0;
};
STUB_POINTERS(NavSatFix);

}  // namespace sensor_msgs
