// In place of ROS: a message of gnss_comm.
#pragma once

#include <cstdint>

#include "../ros/message.h"
#include "GnssTimeMsg.h"

namespace gnss_comm {

struct GnssTimePulseInfoMsg {
  STUB_POINTERS_WITHIN(GnssTimePulseInfoMsg);
  GnssTimeMsg time;
  std::uint8_t utc_based = 0;
  std::uint32_t time_sys = 0;
};
STUB_POINTERS(GnssTimePulseInfoMsg);

}  // namespace gnss_comm
