#pragma once

#include <string>
#include <vector>

#include "core/status.h"
#include "eval/files/strict_yaml.h"

namespace alidade {

/// Values of a foreign calibration as text for a sensor.yaml, whose reader holds them against what a sensor
/// may be.

/// A scalar or nested list as it stands; of an OpenCV matrix its data; '' of anything else.
[[nodiscard]] std::string FlowText(const YAML::Node& node);

/// Entries of a list as they stand; none of anything else.
[[nodiscard]] std::vector<std::string> FlowEntries(const YAML::Node& list);

[[nodiscard]] std::string FlowList(const std::vector<std::string>& entries);

/// The values of these keys of a map as a list. Errors (kInput): the first one that is missing, after `path`.
Result<std::string> FlowListOf(const std::string& path, const YAML::Node& map,
                               const std::vector<const char*>& keys);

/// Of any node; yaml-cpp throws on questions to one that is not there.
[[nodiscard]] bool IsYamlMap(const YAML::Node& node);

/// A key and its value as a line of sensor.yaml.
[[nodiscard]] std::string CalibrationLine(const std::string& key, const std::string& value);

}  // namespace alidade
