// In place of ROS: a message of gnss_comm.
#pragma once

#include <cstdint>

#include "../ros/message.h"
#include "GnssTimeMsg.h"

namespace gnss_comm {

struct GnssGloEphemMsg {
  STUB_POINTERS_WITHIN(GnssGloEphemMsg);
  std::uint32_t sat = 0;
  GnssTimeMsg ttr, toe;
  std::int32_t freqo = 0;
  std::uint32_t iode = 0, health = 0, age = 0;
  double ura = 0;
  double pos_x = 0, pos_y = 0, pos_z = 0, vel_x = 0, vel_y = 0, vel_z = 0, acc_x = 0, acc_y = 0, acc_z = 0;
  double tau_n = 0, gamma = 0, delta_tau_n = 0;
};
STUB_POINTERS(GnssGloEphemMsg);

}  // namespace gnss_comm
