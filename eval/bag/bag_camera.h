#pragma once

#include <cstddef>
#include <map>
#include <vector>

#include "eval/bag/bag_collector.h"
#include "eval/bag/bag_schedule.h"

namespace alidade {

// The cameras in a bag: images of the first one, tracks of all.

[[nodiscard]] std::vector<BagTopic> CameraTopics();

/// Images and tracks of the first camera. kInput: neither a sheet nor a given calibration.
class BagCamera : public BagCollector {
 public:
  Result<bool> Take(const BagMessage& message, BagContext* bag) override;
  Status Assemble(BagContext* bag) override;

 private:
  Status TakeImage(const BagMessage& message, BagContext* bag);
  Status TakeCompressed(const BagMessage& message, BagContext* bag);

  bool has_images_ = false;  ///< that were handed over
};

/// Tracks of the further cameras; those without a sheet become a remark.
class BagExtraCameras : public BagCollector {
 public:
  Result<bool> Take(const BagMessage& message, BagContext* bag) override;
  Status Assemble(BagContext* bag) override;

 private:
  std::map<std::size_t, std::vector<TrackFrame>> frames_;
};

void ScheduleCameras(const Dataset& dataset, const BagTopics& topics, BagSchedule* schedule);
void ScheduleCameraSheets(const Dataset& dataset, BagSchedule* schedule);

}  // namespace alidade
