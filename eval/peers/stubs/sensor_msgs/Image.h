// In place of ROS.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "../ros/message.h"
#include "../std_msgs/Header.h"

namespace sensor_msgs {

struct Image {
  STUB_POINTERS_WITHIN(Image);
  std_msgs::Header header;
  std::uint32_t height = 0, width = 0, step = 0;
  std::string encoding;
  std::uint8_t is_bigendian = 0;
  std::vector<std::uint8_t> data;
};
STUB_POINTERS(Image);

}  // namespace sensor_msgs
