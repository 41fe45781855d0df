#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "eval/bag/bag_sheets.h"
#include "eval/bag/bag_topics.h"
#include "eval/dataset/dataset.h"
#include "eval/rosbag/ros_position_messages.h"
#include "eval/rosbag/rosbag_reader.h"

namespace alidade {

/// Topics of sensor `fix<index>`: sensor_msgs/NavSatFix, and alidade/Position for a frame of its own. That of
/// fix0's NavSatFix is BagTopics::fix.
[[nodiscard]] std::string NavSatFixTopic(const BagTopics& topics, std::size_t index);
[[nodiscard]] std::string PositionTopic(std::size_t index);

/// Collects the position fixes of a bag. A NavSatFix of a topic that was not named is passed over, for its
/// clock and its lever arm are not known.
class BagFixes {
 public:
  /// False: the message is not one of positions. kInput: one that does not decode.
  Result<bool> Take(const BagTopics& topics, const BagMessage& message);
  /// Puts what was taken into the dataset, each sensor as its sheet says; without one, with a lever arm and a
  /// time offset of zero. kInput: a sheet that does not parse.
  Status Assemble(const std::string& path, const BagSheets& sheets, Dataset* dataset,
                  std::vector<std::string>* remarks);

 private:
  struct Sensor {
    std::vector<NavSatFix> on_earth;
    std::vector<PositionFix> local;
  };

  std::map<std::size_t, Sensor> sensors_;
  std::set<std::string> others_;  ///< topics that were passed over
};

}  // namespace alidade
