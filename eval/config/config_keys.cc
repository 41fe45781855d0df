#include "eval/config/config_keys.h"

#include <algorithm>

#include "eval/files/suggest.h"

namespace alidade {
namespace {

std::string Leaf(const std::string& path) {
  return path.substr(path.rfind('.') + 1);
}

}  // namespace

std::string JoinKey(const std::string& prefix, std::string_view name) {
  return prefix.empty() ? std::string(name) : prefix + "." + std::string(name);
}

std::string ConfigKeys::Hint(const std::string& path) const {
  std::vector<std::string> siblings;
  std::vector<std::string> everything;
  const std::string parent = path.substr(0, path.size() - std::min(path.size(), Leaf(path).size()));
  for (const std::set<std::string>* group : {&keys_, &sections_}) {
    for (const std::string& known : *group) {
      if (group == &keys_ && Leaf(known) == Leaf(path)) {
        return "; did you mean '" + known + "'?";  // right name, wrong section
      }
      everything.push_back(known);
      if (known.starts_with(parent) && known.find('.', parent.size()) == std::string::npos) {
        siblings.push_back(known);
      }
    }
  }
  const std::string hint = Suggestion(path, siblings);
  return hint.empty() ? Suggestion(path, everything) : hint;
}

}  // namespace alidade
