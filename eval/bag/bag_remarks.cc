#include "eval/bag/bag_remarks.h"

namespace alidade {

void BagRemarks::AddSkipped(const std::string& topic, const std::string& reason) {
  if (skipped_[topic]++ == 0) {
    Add(topic + ": a message was skipped: " + reason);
  }
}

void BagRemarks::AddDropped(const std::string& topic, std::size_t count) {
  if (count > 0) {
    Add(topic + ": " + std::to_string(count) + " messages with a duplicate stamp, skipped");
  }
}

void BagRemarks::AddTotals() {
  for (const auto& [topic, count] : skipped_) {
    if (count > 1) {
      Add(topic + ": " + std::to_string(count) + " messages skipped in total");
    }
  }
}

}  // namespace alidade
