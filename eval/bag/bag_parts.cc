#include "eval/bag/bag_parts.h"

#include "eval/bag/bag_camera.h"
#include "eval/bag/bag_fixes.h"
#include "eval/bag/bag_gnss.h"
#include "eval/bag/bag_imu.h"
#include "eval/bag/bag_truth.h"

namespace alidade {

Result<BagTopics> MakeBagTopics(const std::string& list) {
  std::vector<BagTopic> all;
  for (const auto& part : {ImuTopics, CameraTopics, TruthTopics, GnssTopics, FixTopics}) {
    const std::vector<BagTopic> topics = part();
    all.insert(all.end(), topics.begin(), topics.end());
  }
  BagTopics topics(all);
  ALIDADE_RETURN_IF_ERROR(topics.Set(list));
  ALIDADE_RETURN_IF_ERROR(CheckFixTopics(topics));
  return topics;
}

std::vector<std::unique_ptr<BagCollector>> MakeBagCollectors() {
  std::vector<std::unique_ptr<BagCollector>> collectors;
  collectors.push_back(std::make_unique<BagImu>());
  collectors.push_back(std::make_unique<BagCamera>());
  collectors.push_back(std::make_unique<BagTruth>());
  collectors.push_back(std::make_unique<BagExtraCameras>());
  collectors.push_back(std::make_unique<BagFixes>());
  collectors.push_back(std::make_unique<BagGnss>());
  return collectors;
}

void ScheduleDataset(const Dataset& dataset, const BagTopics& topics, BagSchedule* schedule) {
  // Topics get their numbers in this order: another one gives other bytes.
  for (const auto& part : {ScheduleImu, ScheduleTruth, ScheduleCameras, ScheduleGnss, ScheduleFixes}) {
    part(dataset, topics, schedule);
  }
  for (const auto& part : {ScheduleImuSheet, ScheduleCameraSheets, ScheduleFixSheets, ScheduleGnssSheet}) {
    part(dataset, schedule);
  }
}

}  // namespace alidade
