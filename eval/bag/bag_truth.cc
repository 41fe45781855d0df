#include "eval/bag/bag_truth.h"

#include "eval/rosbag/ros_sensor_messages.h"

namespace alidade {

std::vector<BagTopic> TruthTopics() {
  return {{"truth", "/ground_truth", {"alidade/State"}}};
}

Result<bool> BagTruth::Take(const BagMessage& message, BagContext* bag) {
  const std::string& topic = message.connection->topic;
  if (message.connection->type != "alidade/State" || topic != bag->topics["truth"]) {
    return false;
  }
  const std::optional<DecodedState> state = DecodeState(message.data);
  if (!state) {
    bag->remarks.AddSkipped(topic, "does not decode");
    return true;
  }
  std::optional<Trajectory>& truth = bag->dataset.truth;
  if (!truth) {
    truth.emplace();
    truth->has_velocity = truth->has_bias = state->has_velocity;
  }
  truth->points.push_back(state->point);
  return true;
}

Status BagTruth::Assemble(BagContext* bag) {
  if (bag->dataset.truth) {
    bag->remarks.AddDropped(bag->topics["truth"], SortByStamp(&bag->dataset.truth->points));
  }
  return Status::Ok();
}

void ScheduleTruth(const Dataset& dataset, const BagTopics& topics, BagSchedule* schedule) {
  if (!dataset.truth || !dataset.truth->has_orientation) {
    return;
  }
  const std::uint32_t topic = schedule->AddTopic(topics["truth"], "alidade/State");
  const bool has_velocity = dataset.truth->has_velocity;
  for (const TrajectoryPoint& point : dataset.truth->points) {
    schedule->Add(point.stamp_ns, topic, [&point, has_velocity] { return EncodeState(point, has_velocity); });
  }
}

}  // namespace alidade
