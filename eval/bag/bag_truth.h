#pragma once

#include <vector>

#include "eval/bag/bag_collector.h"
#include "eval/bag/bag_schedule.h"

namespace alidade {

// The truth in a bag, as alidade writes it.

[[nodiscard]] std::vector<BagTopic> TruthTopics();

class BagTruth : public BagCollector {
 public:
  Result<bool> Take(const BagMessage& message, BagContext* bag) override;
  Status Assemble(BagContext* bag) override;
};

/// Nothing for a truth without orientation, for which there is no message.
void ScheduleTruth(const Dataset& dataset, const BagTopics& topics, BagSchedule* schedule);

}  // namespace alidade
