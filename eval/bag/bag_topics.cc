#include "eval/bag/bag_topics.h"

#include <algorithm>
#include <sstream>
#include <utility>
#include <vector>

#include "eval/files/suggest.h"

namespace alidade {
namespace {

using Found = std::map<std::string, std::string>;

std::string Inventory(const Found& found) {
  std::string text;
  for (const auto& [topic, type] : found) {
    text += (text.empty() ? "" : ", ") + topic + " (" + type + ")";
  }
  return text;
}

/// One sensor's part of BagTopics::Resolve.
Status ResolveOne(const std::string& path, const Found& found, const char* word,
                  const std::vector<std::string>& types, const std::string& by_default, std::string* topic) {
  const auto fits = [&](const std::string& type) {
    return std::find(types.begin(), types.end(), type) != types.end();
  };
  const auto named = found.find(*topic);
  if (named != found.end() && fits(named->second)) {
    return Status::Ok();
  }
  if (*topic != by_default) {
    return Status::Input(path + ": no topic " + *topic + " of type " + types.front() + "; found " +
                         Inventory(found));
  }
  std::vector<std::string> candidates;
  for (const auto& [name, type] : found) {
    if (fits(type)) {
      candidates.push_back(name);
    }
  }
  if (candidates.size() > 1) {
    return Status::Input(path + ": " + std::to_string(candidates.size()) + " topics of type " +
                         types.front() + ", expected --topics=" + word + "=TOPIC to name one; found " +
                         Inventory(found));
  }
  *topic = candidates.empty() ? std::string() : candidates.front();
  return Status::Ok();
}

}  // namespace

Status BagTopics::Set(const std::string& list) {
  const std::vector<std::pair<std::string, std::string*>> words = {{"imu", &imu},
                                                                   {"cam0", &camera},
                                                                   {"tracks", &tracks},
                                                                   {"truth", &truth},
                                                                   {"range", &range},
                                                                   {"ephem", &ephemeris},
                                                                   {"glo_ephem", &glonass_ephemeris},
                                                                   {"iono", &ionosphere},
                                                                   {"pvt", &solution},
                                                                   {"pulse", &time_pulse},
                                                                   {"trigger", &trigger},
                                                                   {"fix", &fix}};
  std::vector<std::string> names;
  for (const auto& [name, topic] : words) {
    names.push_back(name);
  }
  std::istringstream entries(list);
  for (std::string entry; std::getline(entries, entry, ',');) {
    const std::size_t equals = entry.find('=');
    const std::string name = entry.substr(0, equals);
    if (equals == std::string::npos || equals + 1 == entry.size()) {
      return Status::Usage("--topics: found '" + entry + "', expected sensor=/topic");
    }
    bool known = false;
    for (const auto& [word, topic] : words) {
      if (word == name) {
        *topic = entry.substr(equals + 1);
        known = true;
      }
    }
    if (!known) {
      return Status::Usage("--topics: unknown sensor '" + name + "'" + Suggestion(name, names));
    }
  }
  return Status::Ok();
}

Status BagTopics::Resolve(const std::string& path, const std::map<std::string, std::string>& found) {
  const BagTopics usual;
  const struct {
    const char* word;
    std::vector<std::string> types;
    const std::string& by_default;
    std::string* topic;
  } sensors[] = {{"imu", {"sensor_msgs/Imu"}, usual.imu, &imu},
                 {"cam0", {"sensor_msgs/Image", "sensor_msgs/CompressedImage"}, usual.camera, &camera},
                 {"range", {"gnss_comm/GnssMeasMsg"}, usual.range, &range},
                 {"ephem", {"gnss_comm/GnssEphemMsg"}, usual.ephemeris, &ephemeris},
                 {"glo_ephem", {"gnss_comm/GnssGloEphemMsg"}, usual.glonass_ephemeris, &glonass_ephemeris},
                 {"pvt", {"gnss_comm/GnssPVTSolnMsg"}, usual.solution, &solution},
                 {"pulse", {"gnss_comm/GnssTimePulseInfoMsg"}, usual.time_pulse, &time_pulse}};
  for (const auto& sensor : sensors) {
    ALIDADE_RETURN_IF_ERROR(
        ResolveOne(path, found, sensor.word, sensor.types, sensor.by_default, sensor.topic));
  }
  if (fix != usual.fix) {
    ALIDADE_RETURN_IF_ERROR(ResolveOne(path, found, "fix", {"sensor_msgs/NavSatFix"}, usual.fix, &fix));
  }
  return imu.empty() ? Status::Input(path + ": no topic of type sensor_msgs/Imu; found " + Inventory(found))
                     : Status::Ok();
}

}  // namespace alidade
