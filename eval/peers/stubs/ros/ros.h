// In place of ROS: what the peers' sources need to compile. Parameters are set by the drivers.
#pragma once

#include <string>

#include "ros/assert.h"
#include "ros/console.h"

namespace ros {

/// A stamp [s].
class Time {
 public:
  Time() = default;
  explicit Time(double seconds) : seconds_(seconds) {}
  [[nodiscard]] double toSec() const { return seconds_; }

 private:
  double seconds_ = 0;
};

struct NodeHandle {
  template <typename T>
  bool getParam(const std::string&, T&) {
    return false;
  }
  void shutdown() {}
};

}  // namespace ros
