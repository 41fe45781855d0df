#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/status.h"
#include "core/time.h"
#include "eval/rosbag/rosbag_writer.h"

namespace alidade {

/// The messages of a bag that is to be written.
class BagSchedule {
 public:
  /// A message to be made when its turn comes.
  struct Message {
    TimeNs stamp_ns = 0;
    std::uint32_t topic = 0;
    std::function<Result<std::string>()> encode;
  };

  explicit BagSchedule(RosbagWriter* bag) : bag_(bag) {}

  /// Topics are numbered in the order of these calls.
  std::uint32_t AddTopic(const std::string& name, const std::string& type) {
    return bag_->AddTopic(name, type);
  }
  void Add(TimeNs stamp_ns, std::uint32_t topic, std::function<Result<std::string>()> encode);
  /// The sensor.yaml of a sensor, on a topic of its own.
  void AddSheet(const std::string& sensor, const std::string& text);

  /// The first stamp so far, for what has no stamp.
  [[nodiscard]] TimeNs Start() const;
  /// In the order of the stamps; messages of one stamp keep the order in which they were added. Call once,
  /// last.
  [[nodiscard]] std::vector<Message> Take();

 private:
  RosbagWriter* bag_;
  std::vector<Message> messages_;
};

}  // namespace alidade
