#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "eval/bag/bag_topics.h"
#include "eval/dataset/dataset.h"
#include "eval/rosbag/gnss_receiver_messages.h"
#include "eval/rosbag/rosbag_reader.h"

namespace alidade {

/// Collects the GNSS messages of a bag.
class BagGnss {
 public:
  /// kInput: a message of one of its topics that does not decode. Messages of other topics are ignored.
  Status Take(const BagTopics& topics, const BagMessage& message);

  /// Adds the collected messages to the dataset: observations and navigation data; the receiver from `sheet`
  /// (a sensor.yaml, may be empty), else the time offset from pulses and triggers and a zero lever arm.
  /// Without other truth the fixed solutions become the truth. kInput: a sheet that does not parse.
  Status Assemble(const std::string& path, const std::string& sheet, Dataset* dataset,
                  std::vector<std::string>* remarks);

 private:
  /// A trigger with the last announced pulse.
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
