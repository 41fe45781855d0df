// In place of ROS: a message of InGVIO.
#pragma once

#include <vector>

#include "../std_msgs/Header.h"
#include "StereoMeas.h"

namespace feature_tracker {

struct StereoFrame {
  STUB_POINTERS_WITHIN(StereoFrame);
  std_msgs::Header header;
  std::vector<StereoMeas> stereo_features;
};
STUB_POINTERS(StereoFrame);

}  // namespace feature_tracker
