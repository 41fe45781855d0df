#include "eval/bag_topics.h"

#include <sstream>
#include <utility>
#include <vector>

#include "eval/suggest.h"

namespace alidade {

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
                                                                   {"trigger", &trigger}};
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

}  // namespace alidade
