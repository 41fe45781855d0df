// In place of ROS: transforms that are drawn.
#pragma once

#include <string>

#include "../ros/time.h"

namespace tf {

struct Transform {};
struct StampedTransform {
  StampedTransform(const Transform&, const ros::Time&, const std::string&, const std::string&) {}
};
struct TransformBroadcaster {
  void sendTransform(const StampedTransform&) {}
};

}  // namespace tf
