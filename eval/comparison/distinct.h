#pragma once

#include <algorithm>
#include <string>
#include <vector>

namespace alidade {

/// Distinct values in order of first appearance.
template <typename Items, typename Project>
std::vector<std::string> Distinct(const Items& items, Project project) {
  std::vector<std::string> names;
  for (const auto& item : items) {
    const std::string name = project(item);
    if (std::find(names.begin(), names.end(), name) == names.end()) {
      names.push_back(name);
    }
  }
  return names;
}

}  // namespace alidade
