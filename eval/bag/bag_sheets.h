#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>

#include "core/status.h"
#include "eval/dataset/sensor_yaml.h"

namespace alidade {

/// The sensor sheets of a bag, each the text of a sensor.yaml under SheetTopic.
class BagSheets {
 public:
  /// `path`: of the bag, for messages.
  explicit BagSheets(std::string path) : path_(std::move(path)) {}

  /// The first text of a topic counts.
  void Take(const std::string& topic, const std::string& text) { sheets_.try_emplace(topic, text); }

  /// The sheet of "imu0", "cam0", ...; null when there is none.
  [[nodiscard]] const std::string* Text(const std::string& sensor) const;
  /// `given` if set, else the values of the sheet. Errors (kInput): neither exists, or the sheet is invalid.
  [[nodiscard]] Result<ImuSensor> Imu(const std::optional<ImuSensor>& given) const;
  [[nodiscard]] Result<CameraSensor> Camera(const std::string& sensor,
                                            const std::optional<CameraSensor>& given) const;

 private:
  std::string path_;
  std::map<std::string, std::string> sheets_;  ///< topic -> text
};

}  // namespace alidade
