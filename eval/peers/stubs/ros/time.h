// In place of ROS: a stamp.
#pragma once

namespace ros {

class Time {
 public:
  Time() = default;
  explicit Time(double seconds) : seconds_(seconds) {}
  /// Time does not pass: what is stamped with it is stamped by the sequence.
  static Time now() { return {}; }
  Time& fromSec(double seconds) {
    seconds_ = seconds;
    return *this;
  }
  [[nodiscard]] double toSec() const { return seconds_; }

 private:
  double seconds_ = 0;
};

}  // namespace ros
