// In place of ROS: a message of gnss_comm.
#pragma once

#include <cstdint>
#include <vector>

#include "../std_msgs/Header.h"

namespace gnss_comm {

struct GnssSvsMsg {
  std_msgs::Header header;
  std::vector<std::uint32_t> sat, freqo;
  std::vector<std::uint8_t> health;
  std::vector<double> elev_degree, az_degree;
  std::vector<std::uint32_t> sig_mask;
};

}  // namespace gnss_comm
