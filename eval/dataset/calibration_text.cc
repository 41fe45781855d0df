#include "eval/dataset/calibration_text.h"

namespace alidade {

std::string FlowText(const YAML::Node& node) {
  if (!node.IsDefined()) {
    return "''";
  }
  if (node.IsMap()) {
    return FlowText(node["data"]);
  }
  if (!node.IsSequence()) {
    return node.IsScalar() ? node.Scalar() : "''";
  }
  std::string text;
  for (const YAML::Node& entry : node) {
    text += (text.empty() ? "" : ", ") + FlowText(entry);
  }
  return "[" + text + "]";
}

std::vector<std::string> FlowEntries(const YAML::Node& list) {
  std::vector<std::string> entries;
  if (list.IsDefined() && list.IsSequence()) {
    for (const YAML::Node& entry : list) {
      entries.push_back(FlowText(entry));
    }
  }
  return entries;
}

std::string FlowList(const std::vector<std::string>& entries) {
  std::string text;
  for (const std::string& entry : entries) {
    text += (text.empty() ? "" : ", ") + entry;
  }
  return "[" + text + "]";
}

Result<std::string> FlowListOf(const std::string& path, const YAML::Node& map,
                               const std::vector<const char*>& keys) {
  std::string text;
  for (const char* key : keys) {
    if (!IsYamlMap(map) || !map[key].IsDefined()) {
      return Status::Input(path + ": " + key + ": is missing");
    }
    text += (text.empty() ? "" : ", ") + FlowText(map[key]);
  }
  return "[" + text + "]";
}

bool IsYamlMap(const YAML::Node& node) {
  return node.IsDefined() && node.IsMap();
}

std::string CalibrationLine(const std::string& key, const std::string& value) {
  return key + ": " + value + "\n";
}

}  // namespace alidade
