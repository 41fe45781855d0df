#include "eval/bag/bag_fixes.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "eval/dataset/dataset_fix.h"
#include "gnss/base/anchor_llh.h"

namespace alidade {
namespace {

constexpr std::size_t kMaxSensors = 16;
/// The word in --topics that gives the standard deviation of positions without a covariance [m].
constexpr const char* kDeviation = "fix_std_m";

/// In ENU at the sheet's anchor, or at the first of them.
void AddOnEarth(const std::vector<NavSatFix>& messages, int sensor, FixSensor* sheet,
                std::vector<PositionFix>* fixes) {
  sheet->anchor_llh_deg = sheet->anchor_llh_deg.value_or(messages.front().llh_deg);
  const EnuFrame enu = EnuFrameAtLlh(*sheet->anchor_llh_deg);
  for (const NavSatFix& message : messages) {
    const EnuFrame there = EnuFrameAtLlh(message.llh_deg);
    const Eigen::Matrix3d turn = enu.R_EN.transpose() * there.R_EN;
    const Eigen::Matrix3d covariance = turn * message.covariance_N * turn.transpose();
    fixes->push_back({message.stamp_ns, sensor, enu.FromEcef(there.origin_E),
                      0.5 * (covariance + covariance.transpose())});
  }
}

std::string NavSatFixTopic(const BagTopics& topics, std::size_t index) {
  return index == 0 ? topics["fix"] : "/fix" + std::to_string(index) + "/fix";
}

std::string PositionTopic(std::size_t index) {
  return "/fix" + std::to_string(index) + "/position";
}

NavSatFix OnEarth(const PositionFix& fix, const Eigen::Vector3d& anchor_llh_deg) {
  const EnuFrame enu = EnuFrameAtLlh(anchor_llh_deg);
  const Eigen::Vector3d position_E = enu.ToEcef(fix.p_A);
  const Eigen::Matrix3d turn = EnuFrame::At(position_E).R_EN.transpose() * enu.R_EN;
  return {fix.stamp_ns, LlhDegOf(position_E), turn * fix.covariance * turn.transpose()};
}

bool IsLocalPosition(const std::string& type) {
  const std::vector<std::string>& types = LocalPositionTypes();
  return std::find(types.begin(), types.end(), type) != types.end();
}

Result<double> ParseDeviation(const std::string& text) {
  double deviation_m = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), deviation_m);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(deviation_m) ||
      deviation_m <= 0) {
    return Status::Usage(std::string("--topics: ") + kDeviation + ": found '" + text +
                         "', expected metres greater than 0");
  }
  return deviation_m;
}

/// Of the positions of a message's topic that have no covariance.
Result<double> DeviationOf(const BagMessage& message, const BagContext& bag) {
  if (bag.topics.IsNamed(kDeviation)) {
    return ParseDeviation(bag.topics[kDeviation]);
  }
  const std::string& type = message.connection->type;
  return Status::Input(
      bag.path + ": " + message.connection->topic + " (" + type + "): found a position without a " +
      (LocalPositionHasCovariance(type) ? "positive definite " : "") + "covariance, expected --topics=...," +
      kDeviation + "=METRES with its standard deviation");
}

}  // namespace

std::vector<BagTopic> FixTopics() {
  std::vector<std::string> types = LocalPositionTypes();
  types.insert(types.begin(), "sensor_msgs/NavSatFix");
  return {{"fix", "/fix0/fix", std::move(types), BagTopic::Search::kWhenNamed}, {kDeviation, "", {}}};
}

Status CheckFixTopics(const BagTopics& topics) {
  if (!topics.IsNamed(kDeviation)) {
    return Status::Ok();
  }
  if (!topics.IsNamed("fix")) {
    return Status::Usage(std::string("--topics: found ") + kDeviation +
                         " without fix, expected fix=TOPIC with the topic of the positions");
  }
  return ParseDeviation(topics[kDeviation]).status();
}

Result<bool> BagFixes::Take(const BagMessage& message, BagContext* bag) {
  const std::string& topic = message.connection->topic;
  if (IsLocalPosition(message.connection->type) && topic == bag->topics["fix"]) {
    ALIDADE_RETURN_IF_ERROR(TakeLocal(message, bag));
    return true;
  }
  const bool is_position = message.connection->type == "alidade/Position";
  if (!is_position && message.connection->type != "sensor_msgs/NavSatFix") {
    return false;
  }
  for (std::size_t index = 0; index < kMaxSensors; ++index) {
    if (topic != (is_position ? PositionTopic(index) : NavSatFixTopic(bag->topics, index))) {
      continue;
    }
    if (is_position) {
      KeepDecoded(DecodePosition(message.data), topic, &sensors_[index].local, &bag->remarks);
      return true;
    }
    const DecodedNavSatFix decoded = DecodeNavSatFix(message.data);
    if (!decoded.sound) {
      bag->remarks.AddSkipped(topic, "does not decode, or holds no position on Earth");
    } else if (decoded.fix) {
      sensors_[index].on_earth.push_back(*decoded.fix);
    }
    return true;
  }
  others_.insert(topic);
  return true;
}

Status BagFixes::TakeLocal(const BagMessage& message, BagContext* bag) {
  const auto position = DecodeLocalPosition(message.connection->type, message.data);
  if (!position) {
    bag->remarks.AddSkipped(message.connection->topic, "does not decode");
    return Status::Ok();
  }
  PositionFix fix{position->stamp_ns, 0, position->p_A, Eigen::Matrix3d::Identity()};
  if (position->covariance) {
    fix.covariance = *position->covariance;
  } else {
    const Result<double> deviation_m = DeviationOf(message, *bag);
    ALIDADE_RETURN_IF_ERROR(deviation_m.status());
    fix.covariance *= *deviation_m * *deviation_m;
  }
  sensors_[0].local.push_back(fix);
  return Status::Ok();
}

Status BagFixes::Assemble(BagContext* bag) {
  Dataset* dataset = &bag->dataset;
  for (const std::string& topic : others_) {
    bag->remarks.Add(topic + ": position fixes passed over; --topics=fix=" + topic + " takes them");
  }
  for (auto& [index, messages] : sensors_) {
    if (messages.on_earth.empty() && messages.local.empty()) {
      continue;
    }
    const std::string name = "fix" + std::to_string(index);
    FixSensor sheet;
    if (const std::string* text = bag->sheets.Text(name)) {
      const Result<FixSensor> parsed = ParseFixSheet(*text, bag->path + ": " + SheetTopic(name));
      ALIDADE_RETURN_IF_ERROR(parsed.status());
      sheet = *parsed;
    } else {
      bag->remarks.Add(
          name +
          ": lever arm and time offset are not in it and taken as zero; set p_BA and time_offset_s in " +
          name + "/sensor.yaml");
    }
    const auto sensor = static_cast<int>(dataset->rig.fixes.size());
    SortByStamp(&messages.on_earth);
    SortByStamp(&messages.local);
    if (!messages.on_earth.empty()) {
      AddOnEarth(messages.on_earth, sensor, &sheet, &dataset->fixes);
    } else {
      for (PositionFix& fix : messages.local) {
        fix.sensor = sensor;
        dataset->fixes.push_back(fix);
      }
    }
    dataset->rig.fixes.push_back(sheet);
  }
  SortFixes(dataset->rig.fixes, &dataset->fixes);
  return Status::Ok();
}

void ScheduleFixes(const Dataset& dataset, const BagTopics& topics, BagSchedule* schedule) {
  std::vector<std::uint32_t> numbers;
  numbers.reserve(dataset.rig.fixes.size());
  for (std::size_t k = 0; k < dataset.rig.fixes.size(); ++k) {
    numbers.push_back(dataset.rig.fixes[k].anchor_llh_deg
                          ? schedule->AddTopic(NavSatFixTopic(topics, k), "sensor_msgs/NavSatFix")
                          : schedule->AddTopic(PositionTopic(k), "alidade/Position"));
  }
  for (const PositionFix& fix : dataset.fixes) {
    const auto k = static_cast<std::size_t>(fix.sensor);
    const FixSensor& sensor = dataset.rig.fixes[k];
    schedule->Add(fix.stamp_ns + SecondsToNs(sensor.time_offset_s), numbers[k], [&fix, &sensor] {
      return sensor.anchor_llh_deg ? EncodeNavSatFix(OnEarth(fix, *sensor.anchor_llh_deg))
                                   : EncodePosition(fix);
    });
  }
}

void ScheduleFixSheets(const Dataset& dataset, BagSchedule* schedule) {
  for (std::size_t k = 0; k < dataset.rig.fixes.size(); ++k) {
    schedule->AddSheet("fix" + std::to_string(k), FixSensorYaml(dataset.rig.fixes[k]));
  }
}

}  // namespace alidade
