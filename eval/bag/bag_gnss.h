#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "eval/bag/bag_topics.h"
#include "eval/dataset/dataset.h"
#include "eval/rosbag/gnss_messages.h"
#include "eval/rosbag/rosbag_reader.h"

namespace alidade {

/// Collects the GNSS messages of a bag.
class BagGnss {
 public:
  /// kInput: a message of one of its topics that does not decode. Other topics are not its business.
  Status Take(const BagTopics& topics, const BagMessage& message);

  /// Puts what was taken into the dataset: observations and navigation data, the receiver as `sheet` (a
  /// sensor.yaml, may be empty) says, else the time offset from pulses and triggers and a lever arm of zero.
  /// Where there is no other truth, it becomes that of the fixed solutions. kInput: a sheet that does not
  /// parse.
  Status Assemble(const std::string& path, const std::string& sheet, Dataset* dataset,
                  std::vector<std::string>* remarks);

 private:
  /// A trigger with the pulse that was announced last.
  struct Sync {
    TimeNs local_ns = 0;
    TimeNs pulse_ns = 0;
  };

  Status AssembleReceiver(const std::string& path, const std::string& sheet, Dataset* dataset,
                          std::vector<std::string>* remarks) const;
  [[nodiscard]] std::optional<double> TimeOffset() const;
  void AssembleTruth(const std::string& path, Dataset* dataset, std::vector<std::string>* remarks);

  std::vector<ObservationEpoch> epochs_;
  std::map<int, int> glonass_channels_;
  NavigationData navigation_;
  std::vector<ReceiverSolution> fixed_;
  std::optional<TimeNs> pulse_ns_;
  std::vector<Sync> syncs_;
};

}  // namespace alidade
