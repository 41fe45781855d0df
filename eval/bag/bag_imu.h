#pragma once

#include <vector>

#include "eval/bag/bag_collector.h"
#include "eval/bag/bag_schedule.h"

namespace alidade {

// The IMU in a bag.

[[nodiscard]] std::vector<BagTopic> ImuTopics();

/// kInput: fewer than two samples; neither a sheet nor given noise.
class BagImu : public BagCollector {
 public:
  Result<bool> Take(const BagMessage& message, BagContext* bag) override;
  Status Assemble(BagContext* bag) override;
};

void ScheduleImu(const Dataset& dataset, const BagTopics& topics, BagSchedule* schedule);
void ScheduleImuSheet(const Dataset& dataset, BagSchedule* schedule);

}  // namespace alidade
