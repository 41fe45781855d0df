// In place of ROS: a message of gnss_comm.
#pragma once

#include <cstdint>

#include "../ros/message.h"
#include "GnssTimeMsg.h"

namespace gnss_comm {

struct GnssPVTSolnMsg {
  STUB_POINTERS_WITHIN(GnssPVTSolnMsg);
  GnssTimeMsg time;
  std::uint8_t fix_type = 0, valid_fix = 0, diff_soln = 0, carr_soln = 0, num_sv = 0;
  double latitude = 0, longitude = 0, altitude = 0, height_msl = 0, h_acc = 0, v_acc = 0, p_dop = 0;
  double vel_n = 0, vel_e = 0, vel_d = 0, vel_acc = 0;
};
STUB_POINTERS(GnssPVTSolnMsg);

}  // namespace gnss_comm
