// In place of ROS: grey images.
#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <string>

#include "../ros/assert.h"
#include "../sensor_msgs/Image.h"

namespace cv_bridge {

struct CvImage {
  cv::Mat image;
  [[nodiscard]] sensor_msgs::Image toImageMsg() const { return {}; }  // of what is drawn
};
using CvImageConstPtr = std::shared_ptr<const CvImage>;

inline CvImageConstPtr toCvCopy(const sensor_msgs::Image& message, const std::string& encoding) {
  ROS_ASSERT(encoding == "mono8" && message.encoding == "mono8");
  auto copy = std::make_shared<CvImage>();
  copy->image = cv::Mat(static_cast<int>(message.height), static_cast<int>(message.width), CV_8UC1,
                        const_cast<std::uint8_t*>(message.data.data()), message.step)
                    .clone();
  return copy;
}
inline CvImageConstPtr toCvCopy(const sensor_msgs::ImageConstPtr& message, const std::string& encoding) {
  return toCvCopy(*message, encoding);
}
inline CvImageConstPtr cvtColor(const CvImageConstPtr& image, const std::string&) {
  return image;
}

}  // namespace cv_bridge
