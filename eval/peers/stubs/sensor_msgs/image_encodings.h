// In place of ROS.
#pragma once

namespace sensor_msgs::image_encodings {

inline constexpr char MONO8[] = "mono8";
inline constexpr char BGR8[] = "bgr8";

}  // namespace sensor_msgs::image_encodings
