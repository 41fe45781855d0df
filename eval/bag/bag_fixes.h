#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "eval/bag/bag_collector.h"
#include "eval/bag/bag_schedule.h"
#include "eval/rosbag/ros_position_messages.h"

namespace alidade {

// Position fixes in a bag. Sensor `fix<index>` has the topic fix<index>/fix, sensor_msgs/NavSatFix, or, for a
// frame of its own, fix<index>/position, alidade/Position. That of fix0's NavSatFix can be named, and may
// then hold one of LocalPositionTypes instead; the word fix_std_m gives the deviation of positions without a
// covariance.

[[nodiscard]] std::vector<BagTopic> FixTopics();
/// kUsage: fix_std_m is no length, or is set without a topic that it applies to.
[[nodiscard]] Status CheckFixTopics(const BagTopics& topics);

/// Each sensor by its sheet; without one, with a lever arm and a time offset of zero. A NavSatFix of a
/// topic that was not named is passed over, for its clock and its lever arm are not known. kInput: a sheet
/// that does not parse, a position without a positive definite covariance and without fix_std_m.
class BagFixes : public BagCollector {
 public:
  Result<bool> Take(const BagMessage& message, BagContext* bag) override;
  Status Assemble(BagContext* bag) override;

 private:
  /// A message of one of LocalPositionTypes on the named topic.
  Status TakeLocal(const BagMessage& message, BagContext* bag);

  struct Sensor {
    std::vector<NavSatFix> on_earth;
    std::vector<PositionFix> local;
  };

  std::map<std::size_t, Sensor> sensors_;
  std::set<std::string> others_;  ///< topics that were passed over
};

void ScheduleFixes(const Dataset& dataset, const BagTopics& topics, BagSchedule* schedule);
void ScheduleFixSheets(const Dataset& dataset, BagSchedule* schedule);

}  // namespace alidade
