// In place of ROS: a message of gnss_comm.
#pragma once

#include <vector>

#include "../ros/message.h"
#include "GnssObsMsg.h"

namespace gnss_comm {

struct GnssMeasMsg {
  STUB_POINTERS_WITHIN(GnssMeasMsg);
  std::vector<GnssObsMsg> meas;
};
STUB_POINTERS(GnssMeasMsg);

}  // namespace gnss_comm
