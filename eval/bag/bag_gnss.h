#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "eval/bag/bag_collector.h"
#include "eval/bag/bag_schedule.h"
#include "eval/rosbag/gnss_receiver_messages.h"

namespace alidade {

// GNSS in a bag: messages of gnss_comm.

[[nodiscard]] std::vector<BagTopic> GnssTopics();

/// Observations and navigation data; the receiver from the sheet, else the time offset from pulses and
/// triggers and a zero lever arm. Without other truth the fixed solutions become the truth. kInput: a sheet
/// that does not parse.
class BagGnss : public BagCollector {
 public:
  Result<bool> Take(const BagMessage& message, BagContext* bag) override;
  Status Assemble(BagContext* bag) override;

 private:
  /// A trigger with the last announced pulse.
  struct Sync {
    TimeNs local_ns = 0;
    TimeNs pulse_ns = 0;
  };

  /// kInput: does not decode.
  Result<bool> Decode(const BagTopics& topics, const BagMessage& message);
  /// `sheet` may be empty.
  Status AssembleReceiver(const std::string& sheet, BagContext* bag) const;
  [[nodiscard]] std::optional<double> TimeOffset() const;
  void AssembleTruth(BagContext* bag);

  std::vector<ObservationEpoch> epochs_;
  std::map<int, int> glonass_channels_;
  NavigationData navigation_;
  std::vector<ReceiverSolution> fixed_;
  std::optional<TimeNs> pulse_ns_;
  std::vector<Sync> syncs_;
};

void ScheduleGnss(const Dataset& dataset, const BagTopics& topics, BagSchedule* schedule);
void ScheduleGnssSheet(const Dataset& dataset, BagSchedule* schedule);

}  // namespace alidade
