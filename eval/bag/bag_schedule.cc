#include "eval/bag/bag_schedule.h"

#include <algorithm>
#include <utility>

#include "eval/bag/bag_topics.h"
#include "eval/rosbag/ros_sensor_messages.h"

namespace alidade {

void BagSchedule::Add(TimeNs stamp_ns, std::uint32_t topic, std::function<Result<std::string>()> encode) {
  messages_.push_back({stamp_ns, topic, std::move(encode)});
}

void BagSchedule::AddSheet(const std::string& sensor, const std::string& text) {
  const std::uint32_t topic = bag_->AddTopic(SheetTopic(sensor), "std_msgs/String", true);
  Add(Start(), topic, [text] { return EncodeText(text); });
}

TimeNs BagSchedule::Start() const {
  TimeNs start_ns = INT64_MAX;
  for (const Message& message : messages_) {
    start_ns = std::min(start_ns, message.stamp_ns);
  }
  return start_ns;
}

std::vector<BagSchedule::Message> BagSchedule::Take() {
  std::stable_sort(messages_.begin(), messages_.end(),
                   [](const Message& a, const Message& b) { return a.stamp_ns < b.stamp_ns; });
  return std::move(messages_);
}

}  // namespace alidade
