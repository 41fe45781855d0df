#pragma once

#include <memory>
#include <string>
#include <vector>

#include "eval/bag/bag_collector.h"
#include "eval/bag/bag_schedule.h"

namespace alidade {

// What a bag can hold, a line a sensor in each of these lists.

/// The topics that can be named, with the names of `list`: "imu=/imu/data,cam0=/left/image_raw" (docs/bags.md
/// lists the words). kUsage: an unknown word, no name, or one that CheckFixTopics refuses.
Result<BagTopics> MakeBagTopics(const std::string& list);

/// A message goes to the first collector that takes it; datasets are assembled in this order.
[[nodiscard]] std::vector<std::unique_ptr<BagCollector>> MakeBagCollectors();

/// Lists all messages of a sequence, which must outlive the schedule.
void ScheduleDataset(const Dataset& dataset, const BagTopics& topics, BagSchedule* schedule);

}  // namespace alidade
