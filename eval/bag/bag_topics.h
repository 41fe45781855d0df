#pragma once

#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/status.h"

namespace alidade {

/// A topic that a sensor is read from and written to, and that can be named.
struct BagTopic {
  enum class Search {
    kNone,       ///< read if it exists
    kWhenNamed,  ///< a name that was set must exist
    kByType,     ///< found by its types, which must be unique then, if the bag has not its usual name
    kRequired,   ///< the same, and there must be one
  };
  std::string word;  ///< in --topics
  std::string usual_name;
  std::vector<std::string> types;
  Search search = Search::kNone;
};

/// Names of topics; all by their words.
class BagTopics {
 public:
  explicit BagTopics(const std::vector<BagTopic>& topics);

  /// Sets "imu=/imu/data,cam0=/left/image_raw". kUsage: an unknown word, or no name.
  Status Set(const std::string& list);

  /// Replaces a name that a bag does not have by that of the only topic of its types, or by nothing when
  /// there is none. `found`: topic -> type. kInput: a required topic that is missing, a name that was set but
  /// does not exist, an ambiguous topic.
  Status Resolve(const std::string& path, const std::map<std::string, std::string>& found);

  /// Whether Set has named a topic that exists in the list.
  [[nodiscard]] bool IsNamed(std::string_view word) const { return Find(word).is_named; }

  /// The name of a topic that exists in the list.
  [[nodiscard]] const std::string& operator[](std::string_view word) const { return Find(word).name; }

 private:
  struct Named : BagTopic {
    std::string name;
    bool is_named = false;
  };
  [[nodiscard]] const Named& Find(std::string_view word) const;

  std::vector<Named> topics_;
};

/// The sensor.yaml of a sensor ("imu0", "cam0", "gnss0", "cam1") as text in a bag.
[[nodiscard]] inline std::string SheetTopic(const std::string& sensor) {
  return "/" + sensor + "/sensor_yaml";
}

}  // namespace alidade
