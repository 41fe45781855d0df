#include "eval/record/recorder_json.h"

#include <string>
#include <string_view>
#include <vector>

namespace alidade {
namespace {

using Json = nlohmann::ordered_json;

Eigen::Vector3d VectorOf(const Json& json, const char* key) {
  const std::vector<double> values = JsonMember(json, key, std::vector<double>());
  return values.size() == 3 ? Eigen::Vector3d(values.data()) : Eigen::Vector3d::Zero();
}

/// The sensor that aligned the run, by run.json.
std::optional<Sensor> AligningSensor(const Json& run) {
  const auto aligned = [&](std::string_view key) {
    const Json section = JsonMember(run, std::string(key).c_str(), Json::object());
    return JsonMember(section, "aligned", false) && section.contains("aligned_ns");
  };
  if (aligned("gnss")) {
    return Sensor::kGnss;
  }
  std::optional<Sensor> source;
  ForEachSensorEntry(
      [&](auto entry, Sensor sensor) { source = !source && aligned(entry.kKey) ? sensor : source; });
  return source;
}

}  // namespace

std::optional<GlobalFrame> ReadGlobalFrame(const Json& run) {
  const std::optional<Sensor> source = AligningSensor(run);
  if (!source) {
    return std::nullopt;
  }
  const Json json = JsonMember(run, std::string(ToString(*source)).c_str(), Json::object());
  GlobalFrame global;
  if (json.contains("anchor_E")) {
    global.enu = EnuFrame::At(VectorOf(json, "anchor_E"));
  }
  global.source = *source;
  global.p_BA = VectorOf(json, "lever_arm_m");
  global.stamp_ns = JsonMember(json, "aligned_ns", TimeNs{0});
  global.time_offset_s = JsonMember(json, "time_offset_s", 0.0);
  global.yaw_rad = JsonMember(json, "yaw_rad", 0.0);
  global.yaw_std_rad = JsonMember(json, "yaw_std_rad", 0.0);
  return global;
}

}  // namespace alidade
