#pragma once

#include <Eigen/Core>
#include <functional>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace alidade {

/// Name, unit and description of one key of a configuration file.
struct KeyDoc {
  std::string_view name;
  std::string_view unit;    ///< "m", "px", "-", ...
  std::string_view reason;  ///< why the default is what it is, or what the key trades
};

/// Walks the keys of a configuration struct. Each struct lists its keys ONCE, in Describe(ConfigVisitor&);
/// parsing, validation, printing and documentation are visitors over that one list, so no option is written
/// twice. Ranges are inclusive. A visitor that reads never leaves a value outside its range.
class ConfigVisitor {
 public:
  virtual ~ConfigVisitor() = default;

  virtual void Section(std::string_view name, std::string_view reason, const std::function<void()>& keys) = 0;
  virtual void Real(const KeyDoc& doc, double* value, double min, double max) = 0;
  virtual void Integer(const KeyDoc& doc, int* value, int min, int max) = 0;
  virtual void Boolean(const KeyDoc& doc, bool* value) = 0;
  virtual void Text(const KeyDoc& doc, std::string* value) = 0;
  virtual void Vector3(const KeyDoc& doc, Eigen::Vector3d* value, double min, double max) = 0;
  /// One of `options`; *index is the position of the chosen one.
  virtual void Choice(const KeyDoc& doc, const std::vector<std::string_view>& options, int* index) = 0;

  /// Choice over an enum whose enumerators are listed with their configuration names.
  template <typename Enum>
  void Enumeration(const KeyDoc& doc, Enum* value,
                   const std::vector<std::pair<std::string_view, Enum>>& options) {
    std::vector<std::string_view> names;
    int index = 0;
    for (const auto& [name, option] : options) {
      if (option == *value) {
        index = static_cast<int>(names.size());
      }
      names.push_back(name);
    }
    Choice(doc, names, &index);
    *value = options[static_cast<std::size_t>(index)].second;
  }
};

}  // namespace alidade
