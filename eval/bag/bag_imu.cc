#include "eval/bag/bag_imu.h"

#include "eval/dataset/calibration_import.h"
#include "eval/dataset/sensor_table.h"
#include "eval/dataset/sensor_yaml.h"
#include "eval/rosbag/ros_sensor_messages.h"

namespace alidade {

std::vector<BagTopic> ImuTopics() {
  return {{"imu", "/imu0", {"sensor_msgs/Imu"}, BagTopic::Search::kRequired}};
}

Result<bool> BagImu::Take(const BagMessage& message, BagContext* bag) {
  const std::string& topic = message.connection->topic;
  if (message.connection->type != "sensor_msgs/Imu" || topic != bag->topics["imu"]) {
    return false;
  }
  const std::size_t kept = bag->dataset.imu.size();
  KeepDecoded(DecodeImu(message.data), topic, &bag->dataset.imu, &bag->remarks);
  bag->dataset.imu_rejections.not_finite += bag->dataset.imu.size() == kept ? 1 : 0;
  return true;
}

Status BagImu::Assemble(BagContext* bag) {
  Dataset& dataset = bag->dataset;
  const std::string& topic = bag->topics["imu"];
  dataset.imu_rejections.duplicate = SortByStamp(&dataset.imu);
  bag->remarks.AddDropped(topic, dataset.imu_rejections.duplicate);
  if (dataset.imu.size() < 2) {
    return Status::Input(bag->path + ": " + topic + ": " + std::to_string(dataset.imu.size()) +
                         " samples, expected at least two");
  }
  const Result<ImuSensor> sensor = bag->sheets.Imu(bag->options.imu);
  ALIDADE_RETURN_IF_ERROR(sensor.status());
  const double measured_hz =
      MeasuredRate(dataset.imu.front().stamp_ns, dataset.imu.back().stamp_ns, dataset.imu.size());
  const bool per_sample = bag->options.imu && bag->options.imu_is_per_sample;
  dataset.rig.imu_noise = per_sample ? DensitiesOf(sensor->noise, measured_hz) : sensor->noise;
  dataset.imu_rate_hz = sensor->rate_hz.value_or(measured_hz);
  return Status::Ok();
}

void ScheduleImu(const Dataset& dataset, const BagTopics& topics, BagSchedule* schedule) {
  const std::uint32_t topic = schedule->AddTopic(topics["imu"], "sensor_msgs/Imu");
  for (const ImuSample& sample : dataset.imu) {
    schedule->Add(sample.stamp_ns, topic, [&sample] { return EncodeImu(sample); });
  }
}

void ScheduleImuSheet(const Dataset& dataset, BagSchedule* schedule) {
  schedule->AddSheet("imu0", ImuSensorYaml(dataset.rig.imu_noise, dataset.imu_rate_hz));
}

}  // namespace alidade
