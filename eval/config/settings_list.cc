#include <algorithm>
#include <map>

#include "eval/config/config_yaml.h"
#include "eval/files/csv.h"

// The settings of the flag --set as a list.

namespace alidade {

std::vector<std::string> SplitSettings(std::string_view list) {
  std::vector<std::string> settings;
  std::string current;
  int depth = 0;
  for (const char c : list) {
    depth += (c == '[' ? 1 : 0) - (c == ']' ? 1 : 0);
    if (c == ',' && depth <= 0) {
      settings.push_back(current);
      current.clear();
    } else {
      current.push_back(c);
    }
  }
  if (!current.empty()) {
    settings.push_back(current);
  }
  return settings;
}

Status CheckSettingsAgree(const std::vector<std::string>& settings) {
  std::map<std::string_view, std::string_view> values;
  for (const std::string_view setting : settings) {
    const size_t equals = std::min(setting.find('='), setting.size());
    const std::string_view value = setting.substr(std::min(equals + 1, setting.size()));
    const auto [given, first] = values.try_emplace(setting.substr(0, equals), value);
    if (!first && given->second != value) {
      return Status::Config("setting " + Quoted(given->first) + ": found " + Quoted(given->second) + " and " +
                            Quoted(value) + ", expected one value");
    }
  }
  return Status::Ok();
}

}  // namespace alidade
