// In place of ROS: a message of gnss_comm.
#pragma once

#include <cstdint>

namespace gnss_comm {

struct GnssTimeMsg {
  std::uint32_t week = 0;
  double tow = 0;
};

}  // namespace gnss_comm
