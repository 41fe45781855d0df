// In place of ROS: a message of gnss_comm.
#pragma once

#include <vector>

#include "../ros/message.h"
#include "../std_msgs/Header.h"

namespace gnss_comm {

struct StampedFloat64Array {
  STUB_POINTERS_WITHIN(StampedFloat64Array);
  std_msgs::Header header;
  std::vector<double> data;
};
STUB_POINTERS(StampedFloat64Array);

}  // namespace gnss_comm
