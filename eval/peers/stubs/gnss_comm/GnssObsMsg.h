// In place of ROS: a message of gnss_comm.
#pragma once

#include <cstdint>
#include <vector>

#include "GnssTimeMsg.h"

namespace gnss_comm {

struct GnssObsMsg {
  GnssTimeMsg time;
  std::uint32_t sat = 0;
  std::vector<double> freqs, CN0;
  std::vector<std::uint8_t> LLI, code;
  std::vector<double> psr, psr_std, cp, cp_std, dopp, dopp_std;
  std::vector<std::uint8_t> status;
};

}  // namespace gnss_comm
