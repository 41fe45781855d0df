// In place of ROS: a message of InGVIO.
#pragma once

#include <vector>

#include "../std_msgs/Header.h"
#include "MonoMeas.h"

namespace feature_tracker {

struct MonoFrame {
  STUB_POINTERS_WITHIN(MonoFrame);
  std_msgs::Header header;
  std::vector<MonoMeas> mono_features;
};
STUB_POINTERS(MonoFrame);

}  // namespace feature_tracker
