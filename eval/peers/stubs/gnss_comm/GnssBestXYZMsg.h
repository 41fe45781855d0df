// In place of ROS: a message of gnss_comm.
#pragma once

#include <cstdint>
#include <vector>

#include "../std_msgs/Header.h"

namespace gnss_comm {

struct GnssBestXYZMsg {
  std_msgs::Header header;
  std::vector<double> pos, pos_sigma, vel, vel_sigma;
  std::uint32_t num_svs = 0;
};

}  // namespace gnss_comm
