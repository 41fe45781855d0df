// In place of ROS: a message of InGVIO.
#pragma once

#include <cstdint>

#include "../ros/message.h"

namespace feature_tracker {

struct MonoMeas {
  STUB_POINTERS_WITHIN(MonoMeas);
  std::uint64_t id = 0;
  double u0 = 0, v0 = 0;
};
STUB_POINTERS(MonoMeas);

}  // namespace feature_tracker
