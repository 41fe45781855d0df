// In place of ROS: a message of InGVIO.
#pragma once

#include <cstdint>

#include "../ros/message.h"

namespace feature_tracker {

struct StereoMeas {
  STUB_POINTERS_WITHIN(StereoMeas);
  std::uint64_t id = 0;
  double u0 = 0, v0 = 0, u1 = 0, v1 = 0;
};
STUB_POINTERS(StereoMeas);

}  // namespace feature_tracker
