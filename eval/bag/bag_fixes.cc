#include "eval/bag/bag_fixes.h"

#include <algorithm>

#include "eval/dataset/dataset_fix.h"
#include "gnss/base/anchor_llh.h"

namespace alidade {
namespace {

constexpr std::size_t kMaxSensors = 16;

template <typename Entry>
void SortByStamp(std::vector<Entry>* entries) {
  std::stable_sort(entries->begin(), entries->end(),
                   [](const Entry& a, const Entry& b) { return a.stamp_ns < b.stamp_ns; });
  entries->erase(std::unique(entries->begin(), entries->end(),
                             [](const Entry& a, const Entry& b) { return a.stamp_ns == b.stamp_ns; }),
                 entries->end());
}

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

}  // namespace

std::string NavSatFixTopic(const BagTopics& topics, std::size_t index) {
  return index == 0 ? topics.fix : "/fix" + std::to_string(index) + "/fix";
}

std::string PositionTopic(std::size_t index) {
  return "/fix" + std::to_string(index) + "/position";
}

Result<bool> BagFixes::Take(const BagTopics& topics, const BagMessage& message) {
  const std::string& topic = message.connection->topic;
  const bool is_position = message.connection->type == "alidade/Position";
  if (!is_position && message.connection->type != "sensor_msgs/NavSatFix") {
    return false;
  }
  for (std::size_t index = 0; index < kMaxSensors; ++index) {
    if (topic != (is_position ? PositionTopic(index) : NavSatFixTopic(topics, index))) {
      continue;
    }
    if (is_position) {
      const std::optional<PositionFix> fix = DecodePosition(message.data);
      if (!fix) {
        return Status::Input("does not decode");
      }
      sensors_[index].local.push_back(*fix);
      return true;
    }
    const DecodedNavSatFix decoded = DecodeNavSatFix(message.data);
    if (!decoded.sound) {
      return Status::Input("does not decode, or holds no position on Earth");
    }
    if (decoded.fix) {
      sensors_[index].on_earth.push_back(*decoded.fix);
    }
    return true;
  }
  others_.insert(topic);
  return true;
}

Status BagFixes::Assemble(const std::string& path, const BagSheets& sheets, Dataset* dataset,
                          std::vector<std::string>* remarks) {
  for (const std::string& topic : others_) {
    remarks->push_back(path + ": " + topic + ": position fixes passed over; --topics=fix=" + topic +
                       " takes them");
  }
  for (auto& [index, messages] : sensors_) {
    if (messages.on_earth.empty() && messages.local.empty()) {
      continue;
    }
    const std::string name = "fix" + std::to_string(index);
    FixSensor sheet;
    if (const std::string* text = sheets.Text(name)) {
      const Result<FixSensor> parsed = ParseFixSheet(*text, path + ": " + SheetTopic(name));
      ALIDADE_RETURN_IF_ERROR(parsed.status());
      sheet = *parsed;
    } else {
      remarks->push_back(
          path + ": " + name +
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

}  // namespace alidade
